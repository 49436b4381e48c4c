// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pqFFDLatticePropertyWidget.h"

#include "pqFFDLatticePointsModel.h"

#include "vtkFFDEditLatticeRepresentation.h"
#include "vtkFFDLattice.h"

#include "pqApplicationCore.h"
#include "pqCoreUtilities.h"
#include "pqPVApplicationCore.h"
#include "pqPipelineSource.h"
#include "pqPropertiesPanel.h"
#include "pqServerManagerModel.h"
#include "pqUndoStack.h"
#include "pqView.h"

#include "vtk3DWidgetRepresentation.h"
#include "vtkAbstractWidget.h"
#include "vtkBoundingBox.h"
#include "vtkCommand.h"
#include "vtkDoubleArray.h"
#include "vtkPVGeneralSettings.h"
#include "vtkSMProperty.h"
#include "vtkSMPropertyGroup.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMProxy.h"
#include "vtkSMUncheckedPropertyHelper.h"
#include "vtkSMViewProxy.h"
#include "vtkWeakPointer.h"

#include <QCheckBox>
#include <QComboBox>
#include <QDoubleValidator>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QPointer>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSpinBox>
#include <QTableView>
#include <QTimer>
#include <QToolButton>
#include <QVBoxLayout>

#include <algorithm>
#include <array>
#include <vector>

namespace
{

using Rep = vtkFFDEditLatticeRepresentation;
using Sizes = std::array<int, 3>;

constexpr int LargestSize = 64;

/// The panel is a narrow one: what its widgets can be made to, pixels.
constexpr int NarrowWidth = 44;

/// The properties that an edit changes, by their functions.
const char* const EditedFunctions[] = { "Dimensions", "EditDimensions", "Displacements" };

/// Values of a property of integers or reals.
template <class Helper>
std::vector<double> GetValues(vtkSMProperty* property)
{
  Helper helper(property);
  if (property->IsA("vtkSMIntVectorProperty"))
  {
    const std::vector<int> integers = helper.GetIntArray();
    return { integers.begin(), integers.end() };
  }
  return helper.GetDoubleArray();
}

template <class Helper>
void SetValues(vtkSMProperty* property, const std::vector<double>& values)
{
  Helper helper(property);
  const auto count = static_cast<unsigned int>(values.size());
  if (count == 0)
  {
    helper.SetNumberOfElements(0);
    return;
  }
  if (property->IsA("vtkSMIntVectorProperty"))
  {
    std::vector<int> integers;
    for (const double value : values)
    {
      integers.push_back(static_cast<int>(value));
    }
    helper.Set(integers.data(), count);
    return;
  }
  helper.Set(values.data(), count);
}

std::vector<double> GetUnchecked(vtkSMProperty* property)
{
  return GetValues<vtkSMUncheckedPropertyHelper>(property);
}

std::vector<double> GetChecked(vtkSMProperty* property)
{
  return GetValues<vtkSMPropertyHelper>(property);
}

void SetUnchecked(vtkSMProperty* property, const std::vector<double>& values)
{
  SetValues<vtkSMUncheckedPropertyHelper>(property, values);
}

void SetChecked(vtkSMProperty* property, const std::vector<double>& values)
{
  SetValues<vtkSMPropertyHelper>(property, values);
}

Sizes ToSizes(const std::vector<double>& values)
{
  Sizes sizes = { { 0, 0, 0 } };
  for (std::size_t a = 0; a < 3 && a < values.size(); ++a)
  {
    sizes[a] = static_cast<int>(values[a]);
  }
  return sizes;
}

std::vector<double> ToValues(const Sizes& sizes)
{
  return { sizes.begin(), sizes.end() };
}

std::size_t CountValues(const Sizes& sizes)
{
  return 3 * static_cast<std::size_t>(sizes[0]) * static_cast<std::size_t>(sizes[1]) *
    static_cast<std::size_t>(sizes[2]);
}

/// A line for a number. What is shown is rounded, so a number counts only if it was typed.
class NumberEdit : public QLineEdit
{
public:
  NumberEdit(QWidget* parent, const QString& name, const QString& help)
    : QLineEdit(parent)
  {
    this->setObjectName(name);
    this->setToolTip(help);
    this->setMinimumWidth(NarrowWidth);
    this->setValidator(new QDoubleValidator(this));
  }

  /// Unless the user is typing.
  void show(const QString& text)
  {
    if (!this->hasFocus() || this->text() == this->Shown)
    {
      this->Shown = text;
      this->setText(text);
    }
  }

  bool takeTyped(double& number)
  {
    bool isNumber = false;
    const double typed = this->text().toDouble(&isNumber);
    if (!isNumber || this->text() == this->Shown)
    {
      return false;
    }
    this->Shown = this->text();
    number = typed;
    return true;
  }

private:
  QString Shown;
};

QComboBox* MakeChoice(QWidget* parent, const char* name, const QStringList& texts,
  const QList<int>& values, const QString& help)
{
  auto* choice = new QComboBox(parent);
  choice->setObjectName(name);
  choice->setToolTip(help);
  choice->setMinimumWidth(NarrowWidth);
  for (int n = 0; n < texts.size(); ++n)
  {
    choice->addItem(texts[n], values[n]);
  }
  return choice;
}

QCheckBox* MakeCheck(QWidget* parent, const char* name, const QString& text, const QString& help)
{
  auto* check = new QCheckBox(text, parent);
  check->setObjectName(name);
  check->setToolTip(help);
  return check;
}

} // namespace

//-----------------------------------------------------------------------------
class pqFFDLatticePropertyWidget::pqInternals
{
public:
  std::array<QSpinBox*, 3> Resolution;
  QComboBox* Handle = nullptr;
  QComboBox* Constraint = nullptr;
  QCheckBox* Soft = nullptr;
  NumberEdit* Radius = nullptr;
  QComboBox* Falloff = nullptr;
  std::array<QCheckBox*, 3> Symmetry;
  QCheckBox* Lock = nullptr;
  QComboBox* FoldGuard = nullptr;
  QCheckBox* Interior = nullptr;
  QCheckBox* Curved = nullptr;
  QLabel* Selected = nullptr;
  QLabel* Volume = nullptr;
  std::array<NumberEdit*, 3> Center;
  QPushButton* ResetSelected = nullptr;
  pqFFDLatticePointsModel* Points = nullptr;
  QTableView* Table = nullptr;

  QTimer ShowTimer;
  QTimer SettleTimer;
  QTimer FinishTimer;

  QPointer<pqProxy> Source;
  Rep* Representation = nullptr;
  vtkAbstractWidget* Widget = nullptr;

  struct Observation
  {
    vtkWeakPointer<vtkObject> Subject;
    unsigned long Tag;
  };
  std::vector<Observation> Observations;

  void Observe(vtkObject* subject, unsigned long event, QObject* receiver, const char* slot)
  {
    this->Observations.push_back(
      { subject, pqCoreUtilities::connect(subject, event, receiver, slot) });
  }

  void StopObserving()
  {
    for (const Observation& observation : this->Observations)
    {
      if (observation.Subject)
      {
        observation.Subject->RemoveObserver(observation.Tag);
      }
    }
    this->Observations.clear();
  }

  Sizes EditedSizes = { { 0, 0, 0 } }; // what the displacements were last seen to fit
  bool Away = false;          // the panel shows another source
  bool VisibleBefore = false; // whether the lattice was shown when it went
  bool Interacting = false;
  bool Live = false; // the filter has followed steps of the drag
  bool WasUnmodified = false;
  std::vector<std::vector<double>> Start; // values of EditedFunctions before the drag
};

//-----------------------------------------------------------------------------
pqFFDLatticePropertyWidget::pqFFDLatticePropertyWidget(
  vtkSMProxy* smproxy, vtkSMPropertyGroup* smgroup, QWidget* parentObject)
  : Superclass(
      "representations", "FFDLatticeWidgetRepresentation", smproxy, smgroup, parentObject)
  , Internals(new pqInternals())
{
  pqInternals& in = *this->Internals;
  if (auto* view =
        vtk3DWidgetRepresentation::SafeDownCast(this->widgetProxy()->GetClientSideObject()))
  {
    in.Representation = Rep::SafeDownCast(view->GetRepresentation());
    in.Widget = view->GetWidget();
  }
  auto* model = pqApplicationCore::instance()->getServerManagerModel();
  in.Source = model->findItem<pqProxy*>(smproxy);

  this->makeControls();

  for (QTimer* timer : { &in.ShowTimer, &in.SettleTimer, &in.FinishTimer })
  {
    timer->setSingleShot(true);
    timer->setInterval(0);
  }
  this->connect(&in.ShowTimer, SIGNAL(timeout()), SLOT(showState()));
  this->connect(&in.SettleTimer, SIGNAL(timeout()), SLOT(settleResolution()));
  this->connect(&in.FinishTimer, SIGNAL(timeout()), SLOT(finishInteraction()));

  this->connect(this, SIGNAL(startInteraction()), SLOT(onStartInteraction()));
  this->connect(this, SIGNAL(interaction()), SLOT(onInteraction()));
  this->connect(this, SIGNAL(endInteraction()), SLOT(onEndInteraction()));
  if (in.Representation)
  {
    in.Observe(in.Representation, vtkCommand::SelectionChangedEvent, this,
      SLOT(onSelectionChanged()));
    in.Observe(in.Representation, vtkCommand::ModifiedEvent, this, SLOT(scheduleShow()));
  }
  for (const char* function : EditedFunctions)
  {
    if (vtkSMProperty* property = smgroup->GetProperty(function))
    {
      in.Observe(
        property, vtkCommand::UncheckedPropertyModifiedEvent, this, SLOT(scheduleSettle()));
    }
  }
  if (auto* source = qobject_cast<pqPipelineSource*>(in.Source))
  {
    this->connect(source, SIGNAL(dataUpdated(pqPipelineSource*)), SLOT(takeBase()));
  }
  this->settleResolution();
  this->showState();
}

//-----------------------------------------------------------------------------
pqFFDLatticePropertyWidget::~pqFFDLatticePropertyWidget()
{
  // The superclass takes the widget out of the view, which is an event.
  this->Internals->StopObserving();
}

//-----------------------------------------------------------------------------
void pqFFDLatticePropertyWidget::makeControls()
{
  pqInternals& in = *this->Internals;
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(pqPropertiesPanel::suggestedVerticalSpacing());

  auto* show = MakeCheck(this, "show3DWidget", tr("Show Lattice"),
    tr("Show the lattice in the view. Drag control points; click selects, shift and click adds, "
       "shift and drag selects a rectangle. Keys x, y, z constrain to an axis, a selects all, "
       "g, r, s choose the handle."));
  show->setChecked(true);
  layout->addWidget(show);
  this->connect(show, SIGNAL(toggled(bool)), SLOT(setWidgetVisible(bool)));
  show->connect(this, SIGNAL(widgetVisibilityToggled(bool)), SLOT(setChecked(bool)));

  auto* grid = new QGridLayout();
  grid->setHorizontalSpacing(pqPropertiesPanel::suggestedHorizontalSpacing());
  grid->setVerticalSpacing(pqPropertiesPanel::suggestedVerticalSpacing());
  grid->setColumnStretch(1, 1);
  layout->addLayout(grid);
  int line = 0;
  const auto addRow = [this, grid, &line](const QString& label, const QList<QWidget*>& widgets) {
    auto* row = new QHBoxLayout();
    for (QWidget* widget : widgets)
    {
      row->addWidget(widget, 1);
    }
    grid->addWidget(new QLabel(label, this), line, 0);
    grid->addLayout(row, line, 1);
    ++line;
  };

  vtkSMProperty* resolution = this->propertyGroup()->GetProperty("Dimensions");
  QList<QWidget*> row;
  for (std::size_t a = 0; a < 3; ++a)
  {
    auto* spin = new QSpinBox(this);
    spin->setObjectName(QString("Resolution_%1").arg(a));
    spin->setRange(4, LargestSize);
    spin->setKeyboardTracking(false);
    spin->setMinimumWidth(NarrowWidth);
    spin->setToolTip(tr("Control points along each axis. A change keeps what was edited."));
    in.Resolution[a] = spin;
    row << spin;
    if (resolution)
    {
      this->addPropertyLink(
        spin, "value", SIGNAL(valueChanged(int)), resolution, static_cast<int>(a));
    }
  }
  addRow(tr("Resolution"), row);

  row.clear();
  const auto addSelector = [this, &row](const char* name, const QString& text, const QString& help,
                             void (Rep::*method)()) {
    auto* button = new QToolButton(this);
    button->setText(text);
    button->setObjectName(name);
    button->setToolTip(help);
    button->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
    QObject::connect(button, &QToolButton::clicked, this, [this, method]() {
      if (Rep* representation = this->Internals->Representation)
      {
        (representation->*method)();
        this->render();
      }
    });
    row << button;
  };
  addSelector("SelectAll", tr("All"), tr("Select all control points (a)"), &Rep::SelectAll);
  addSelector("SelectNone", tr("None"), tr("Select none (A)"), &Rep::ClearSelection);
  addSelector("InvertSelection", tr("Invert"), tr("Select the others (I)"), &Rep::InvertSelection);
  addRow(tr("Select"), row);
  row.clear();
  addSelector("GrowSelection", tr("Grow"), tr("Add the neighbours (+)"), &Rep::GrowSelection);
  addSelector(
    "ShrinkSelection", tr("Shrink"), tr("Leave the outermost ones out (-)"), &Rep::ShrinkSelection);
  addRow(QString(), row);

  in.Handle = MakeChoice(this, "Handle", { tr("Move"), tr("Turn"), tr("Scale"), tr("None") },
    { Rep::HANDLE_TRANSLATE, Rep::HANDLE_ROTATE, Rep::HANDLE_SCALE, Rep::HANDLE_OFF },
    tr("The handle of the selection (g, r, s)"));
  in.Constraint = MakeChoice(this, "Constraint",
    { tr("Free"), tr("X axis"), tr("Y axis"), tr("Z axis"), tr("YZ plane"), tr("XZ plane"),
      tr("XY plane") },
    { Rep::FREE, Rep::ALONG_X, Rep::ALONG_Y, Rep::ALONG_Z, Rep::ACROSS_X, Rep::ACROSS_Y,
      Rep::ACROSS_Z },
    tr("What drags keep to (x, y, z; with shift the plane across the axis)"));
  addRow(tr("Handle"), { in.Handle });
  addRow(tr("Constraint"), { in.Constraint });

  in.Soft = MakeCheck(this, "SoftEditing", tr("Soft"),
    tr("Control points near the selection follow (o)"));
  in.Radius = new NumberEdit(this, "SoftRadius",
    tr("How far soft editing reaches, in units of the data; 0: two control points far. "
       "The mouse wheel over a control point changes it, too."));
  in.Falloff = MakeChoice(this, "Falloff",
    { tr("Smooth"), tr("Linear"), tr("Sphere"), tr("Sharp"), tr("Constant") },
    { Rep::SMOOTH, Rep::LINEAR, Rep::SPHERE, Rep::SHARP, Rep::CONSTANT },
    tr("How soft editing fades with the distance (O)"));
  addRow(tr("Editing"), { in.Soft, in.Falloff });
  addRow(tr("Radius"), { in.Radius });

  row.clear();
  for (std::size_t a = 0; a < 3; ++a)
  {
    const QString axis(QChar('X' + static_cast<int>(a)));
    in.Symmetry[a] = MakeCheck(this, qPrintable("Symmetry" + axis), axis,
      tr("Edits are mirrored across the middle of this axis (m)"));
    row << in.Symmetry[a];
  }
  in.Lock = MakeCheck(this, "LockBoundary", tr("Locked"),
    tr("The three outermost layers of control points stay, so that the faces of the lattice do (l)"));
  addRow(tr("Symmetry"), row);

  in.FoldGuard = MakeChoice(this, "FoldGuard", { tr("Off"), tr("Stop Edits"), tr("Warn") },
    { Rep::GUARD_OFF, Rep::GUARD_CLAMP, Rep::GUARD_WARN },
    tr("What to do about edits that fold the volume: nothing, stop there, or show the lattice in "
       "red (v)"));
  in.Interior = MakeCheck(this, "InteriorPoints", tr("Interior"),
    tr("Show the control points inside, too"));
  in.Curved = MakeCheck(this, "CurvedLines", tr("Curved"),
    tr("Show what the grid lines of the lattice become, not the lines between control points"));
  addRow(tr("Folds"), { in.FoldGuard });
  addRow(tr("Boundary"), { in.Lock });
  addRow(tr("Show"), { in.Interior, in.Curved });

  in.Selected = new QLabel(this);
  in.Selected->setWordWrap(true);
  in.Selected->setObjectName("SelectedPoints");
  layout->addWidget(in.Selected);
  row.clear();
  for (std::size_t a = 0; a < 3; ++a)
  {
    in.Center[a] = new NumberEdit(this, QString("Center_%1").arg(a),
      tr("Centre of the selected control points; a new one moves them all."));
    this->connect(in.Center[a], SIGNAL(editingFinished()), SLOT(moveSelection()));
    row << in.Center[a];
  }
  auto* center = new QHBoxLayout();
  center->addWidget(new QLabel(tr("Centre"), this));
  for (QWidget* widget : row)
  {
    center->addWidget(widget);
  }
  layout->addLayout(center);

  in.Points = new pqFFDLatticePointsModel(this);
  in.Table = new QTableView(this);
  in.Table->setObjectName("Points");
  in.Table->setModel(in.Points);
  in.Table->setToolTip(tr("Positions of the selected control points. Double click to change one."));
  in.Table->horizontalHeader()->setSectionResizeMode(QHeaderView::Stretch);
  in.Table->verticalHeader()->setDefaultSectionSize(in.Table->fontMetrics().height() + 6);
  in.Table->setMinimumHeight(6 * (in.Table->fontMetrics().height() + 6));
  in.Table->setMaximumHeight(8 * (in.Table->fontMetrics().height() + 6));
  layout->addWidget(in.Table);
  this->connect(in.Points, SIGNAL(pointEdited(int, int, int, double, double, double)),
    SLOT(movePoint(int, int, int, double, double, double)));

  in.ResetSelected = new QPushButton(tr("Reset Points"), this);
  in.ResetSelected->setObjectName("ResetSelected");
  in.ResetSelected->setToolTip(tr("The selected control points back to rest (Delete)"));
  this->connect(in.ResetSelected, SIGNAL(clicked()), SLOT(resetSelection()));
  auto* resetAll = new QPushButton(tr("Reset"), this);
  resetAll->setObjectName("ResetLattice");
  resetAll->setToolTip(
    tr("Take back all that was dragged or typed in; shape and lattice of the input stay."));
  this->connect(resetAll, SIGNAL(clicked()), SLOT(resetEdits()));
  auto* refineButton = new QPushButton(tr("Refine"), this);
  refineButton->setObjectName("Refine");
  refineButton->setToolTip(
    tr("Twice as many cells along each axis, and the same displacements."));
  this->connect(refineButton, SIGNAL(clicked()), SLOT(refine()));
  for (QPushButton* button : { in.ResetSelected, resetAll, refineButton })
  {
    button->setMinimumWidth(NarrowWidth);
  }
  auto* buttons = new QHBoxLayout();
  buttons->addWidget(refineButton);
  buttons->addWidget(in.ResetSelected);
  buttons->addWidget(resetAll);
  layout->addLayout(buttons);
  in.Volume = new QLabel(this);
  in.Volume->setObjectName("VolumeChange");
  in.Volume->setWordWrap(true);
  in.Volume->setToolTip(
    tr("Proven lower bound of the local change of volume. The lattice folds only if it is not "
       "positive."));
  layout->addWidget(in.Volume);

  for (QComboBox* choice : { in.Handle, in.Constraint, in.Falloff, in.FoldGuard })
  {
    this->connect(choice, SIGNAL(currentIndexChanged(int)), SLOT(setOptions()));
  }
  for (QCheckBox* check : { in.Soft, in.Symmetry[0], in.Symmetry[1], in.Symmetry[2], in.Lock,
         in.Interior, in.Curved })
  {
    this->connect(check, SIGNAL(toggled(bool)), SLOT(setOptions()));
  }
  this->connect(in.Radius, SIGNAL(editingFinished()), SLOT(setOptions()));
  this->setWidgetVisible(show->isChecked());
}

//-----------------------------------------------------------------------------
void pqFFDLatticePropertyWidget::apply()
{
  this->settleResolution();
  this->Superclass::apply();
  for (const char* function : EditedFunctions)
  {
    if (vtkSMProperty* property = this->propertyGroup()->GetProperty(function))
    {
      const std::vector<double> values = GetUnchecked(property);
      if (values != GetChecked(property))
      {
        SetChecked(property, values);
      }
    }
  }
}

//-----------------------------------------------------------------------------
void pqFFDLatticePropertyWidget::reset()
{
  for (const char* function : EditedFunctions)
  {
    if (vtkSMProperty* property = this->propertyGroup()->GetProperty(function))
    {
      SetUnchecked(property, GetChecked(property));
    }
  }
  this->Superclass::reset();
}

//-----------------------------------------------------------------------------
/// The superclass looks at the widget, which may be out of sight already, to know what to show later.
void pqFFDLatticePropertyWidget::hideEvent(QHideEvent* event)
{
  pqInternals& in = *this->Internals;
  if (!in.Away)
  {
    in.Away = true;
    in.VisibleBefore = this->isWidgetVisible();
  }
  this->Superclass::hideEvent(event);
}

//-----------------------------------------------------------------------------
void pqFFDLatticePropertyWidget::showEvent(QShowEvent* event)
{
  pqInternals& in = *this->Internals;
  this->Superclass::showEvent(event);
  if (in.Away)
  {
    in.Away = false;
    this->setWidgetVisible(in.VisibleBefore);
  }
}

//-----------------------------------------------------------------------------
void pqFFDLatticePropertyWidget::placeWidget()
{
  this->takeBase();
}

//-----------------------------------------------------------------------------
/// What the edits are added to, from the filter.
void pqFFDLatticePropertyWidget::takeBase()
{
  if (this->Internals->Interacting)
  {
    return;
  }
  vtkSMProxy* filter = this->proxy();
  filter->UpdatePropertyInformation();
  vtkSMProxy* widget = this->widgetProxy();
  const auto copy = [filter, widget](const char* from, const char* to) {
    SetChecked(widget->GetProperty(to), GetChecked(filter->GetProperty(from)));
  };
  double domain[6] = { 0.0, 0.0, 0.0, 0.0, 0.0, 0.0 };
  vtkSMPropertyHelper(filter, "LatticeDomain").Get(domain, 6);
  if (!(domain[0] < domain[1] && domain[2] < domain[3] && domain[4] < domain[5]))
  {
    return;
  }
  copy("LatticeDomain", "Domain");
  copy("LatticeDimensions", "BaseDimensions");
  copy("BaseDisplacements", "BaseDisplacements");
  copy("LatticeDisplacementScale", "DisplacementScale");
  const vtkBoundingBox box = this->dataBounds();
  if (box.IsValid())
  {
    double bounds[6];
    box.GetBounds(bounds);
    vtkSMPropertyHelper(widget, "OutlineBounds").Set(bounds, 6);
  }
  widget->UpdateVTKObjects();
  this->render();
}

//-----------------------------------------------------------------------------
void pqFFDLatticePropertyWidget::onStartInteraction()
{
  pqInternals& in = *this->Internals;
  if (in.FinishTimer.isActive())
  {
    in.FinishTimer.stop();
    this->finishInteraction();
  }
  in.Interacting = true;
  in.Live = false;
  in.WasUnmodified = in.Source && in.Source->modifiedState() == pqProxy::UNMODIFIED;
  in.Start.clear();
  for (const char* function : EditedFunctions)
  {
    in.Start.push_back(GetChecked(this->propertyGroup()->GetProperty(function)));
  }
}

//-----------------------------------------------------------------------------
/// With auto-apply the filter follows; what undo is to know comes at the end.
void pqFFDLatticePropertyWidget::onInteraction()
{
  pqInternals& in = *this->Internals;
  if (!in.Representation || !in.Source || in.Source->modifiedState() == pqProxy::UNINITIALIZED ||
    !vtkPVGeneralSettings::GetInstance()->GetAutoApply())
  {
    return;
  }
  // The signal comes before the properties of the widget are brought up to date.
  this->widgetProxy()->UpdatePropertyInformation();
  this->widgetProxy()->UpdateVTKObjects();
  bool changes = false;
  for (const char* function : EditedFunctions)
  {
    vtkSMProperty* property = this->propertyGroup()->GetProperty(function);
    changes = changes || GetUnchecked(property) != GetChecked(property);
  }
  if (!changes)
  {
    return;
  }
  in.Live = true;
  {
    const pqScopedUndoExclude exclude;
    for (const char* function : EditedFunctions)
    {
      vtkSMProperty* property = this->propertyGroup()->GetProperty(function);
      SetChecked(property, GetUnchecked(property));
    }
    this->proxy()->UpdateVTKObjects();
  }
  if (this->view())
  {
    // The widget renders when this is done.
    this->view()->getViewProxy()->Update();
  }
}

//-----------------------------------------------------------------------------
void pqFFDLatticePropertyWidget::onEndInteraction()
{
  // Once the properties of the widget are up to date.
  this->Internals->FinishTimer.start();
}

//-----------------------------------------------------------------------------
void pqFFDLatticePropertyWidget::finishInteraction()
{
  pqInternals& in = *this->Internals;
  if (!in.Interacting)
  {
    return;
  }
  in.Interacting = false;
  std::vector<std::vector<double>> values;
  for (const char* function : EditedFunctions)
  {
    values.push_back(GetUnchecked(this->propertyGroup()->GetProperty(function)));
  }
  if (in.Live)
  {
    // As if nothing had been applied since the start of the drag: Apply then makes one step of
    // undo, and one of the trace, of it.
    in.Live = false;
    {
      const pqScopedUndoExclude exclude;
      for (std::size_t n = 0; n < values.size(); ++n)
      {
        SetChecked(this->propertyGroup()->GetProperty(EditedFunctions[n]), in.Start[n]);
      }
      this->proxy()->UpdateVTKObjects();
    }
    for (std::size_t n = 0; n < values.size(); ++n)
    {
      SetUnchecked(this->propertyGroup()->GetProperty(EditedFunctions[n]), values[n]);
    }
    Q_EMIT pqPVApplicationCore::instance()->triggerApply();
  }
  else if (in.WasUnmodified && values == in.Start && in.Source)
  {
    // A click that only selected.
    in.Source->setModifiedState(pqProxy::UNMODIFIED);
  }
  this->scheduleShow();
}

//-----------------------------------------------------------------------------
void pqFFDLatticePropertyWidget::onSelectionChanged()
{
  // For the render server, which may draw the picture.
  this->widgetProxy()->UpdatePropertyInformation();
  this->widgetProxy()->UpdateVTKObjects();
  this->scheduleShow();
}

//-----------------------------------------------------------------------------
void pqFFDLatticePropertyWidget::scheduleShow()
{
  this->Internals->ShowTimer.start();
}

//-----------------------------------------------------------------------------
/// Keys change options as well: show what is so, and tell the render server.
void pqFFDLatticePropertyWidget::showState()
{
  pqInternals& in = *this->Internals;
  Rep* rep = in.Representation;
  if (!rep)
  {
    return;
  }
  const auto choose = [](QComboBox* choice, int value) {
    const QSignalBlocker blocker(choice);
    choice->setCurrentIndex(choice->findData(value));
  };
  const auto check = [](QCheckBox* box, bool on) {
    const QSignalBlocker blocker(box);
    box->setChecked(on);
  };
  choose(in.Handle, rep->GetHandleMode());
  choose(in.Constraint, rep->GetConstraint());
  choose(in.Falloff, rep->GetFalloff());
  choose(in.FoldGuard, rep->GetFoldGuard());
  check(in.Soft, rep->GetProportionalEditing() != 0);
  for (int a = 0; a < 3; ++a)
  {
    check(in.Symmetry[static_cast<std::size_t>(a)], rep->GetSymmetry()[a] != 0);
  }
  check(in.Lock, rep->GetLockBoundary() != 0);
  check(in.Interior, rep->GetInteriorVisibility() != 0);
  check(in.Curved, rep->GetLineMode() == Rep::CURVED);
  in.Radius->show(QString::number(rep->GetProportionalRadius(), 'g', 6));
  in.Radius->setEnabled(in.Soft->isChecked());
  in.Falloff->setEnabled(in.Soft->isChecked());

  const vtkIdType count = rep->GetNumberOfSelectedPoints();
  in.Selected->setText(tr("%1 of %2 control points selected")
                         .arg(count)
                         .arg(rep->GetLattice()->GetNumberOfControlPoints()));
  double center[3];
  rep->GetSelectionCenter(center);
  for (std::size_t a = 0; a < 3; ++a)
  {
    in.Center[a]->setEnabled(count > 0);
    in.Center[a]->show(count > 0 ? QString::number(center[a], 'g', 6) : QString());
  }
  in.ResetSelected->setEnabled(count > 0);
  in.Points->update(rep);
  if (!in.Interacting)
  {
    const double bound = rep->GetLattice()->GetMinimumJacobianBound();
    in.Volume->setText(bound > 0.0
        ? tr("Volume changes locally by a factor of %1 at least.").arg(bound, 0, 'g', 3)
        : tr("The lattice may fold (bound of the change of volume: %1).").arg(bound, 0, 'g', 3));
  }
  this->setOptions();
}

//-----------------------------------------------------------------------------
/// What the controls say, to the widget and its copy on the render server.
void pqFFDLatticePropertyWidget::setOptions()
{
  pqInternals& in = *this->Internals;
  vtkSMProxy* widget = this->widgetProxy();
  const auto set = [widget](const char* name, auto value) {
    vtkSMPropertyHelper(widget, name).Set(value);
  };
  set("HandleMode", in.Handle->currentData().toInt());
  set("Constraint", in.Constraint->currentData().toInt());
  set("ProportionalEditing", in.Soft->isChecked());
  set("Falloff", in.Falloff->currentData().toInt());
  const int symmetry[3] = { in.Symmetry[0]->isChecked(), in.Symmetry[1]->isChecked(),
    in.Symmetry[2]->isChecked() };
  vtkSMPropertyHelper(widget, "Symmetry").Set(symmetry, 3);
  set("LockBoundary", in.Lock->isChecked());
  set("FoldGuard", in.FoldGuard->currentData().toInt());
  set("InteriorVisibility", in.Interior->isChecked());
  set("LineMode", in.Curved->isChecked() ? Rep::CURVED : Rep::STRAIGHT);
  if (in.Representation)
  {
    double radius = in.Representation->GetProportionalRadius();
    in.Radius->takeTyped(radius);
    set("ProportionalRadius", std::max(radius, 0.0));
  }
  widget->UpdateVTKObjects();
  in.Radius->setEnabled(in.Soft->isChecked());
  in.Falloff->setEnabled(in.Soft->isChecked());
  if (this->sender() && this->sender() != &in.ShowTimer)
  {
    this->render();
  }
}

//-----------------------------------------------------------------------------
void pqFFDLatticePropertyWidget::scheduleSettle()
{
  this->Internals->SettleTimer.start();
}

//-----------------------------------------------------------------------------
/**
 * Displacements of another resolution are told to be so. Not at once: Undo and scripts change the
 * properties one after the other.
 */
void pqFFDLatticePropertyWidget::settleResolution()
{
  pqInternals& in = *this->Internals;
  vtkSMPropertyGroup* group = this->propertyGroup();
  vtkSMProperty* editSizes = group->GetProperty("EditDimensions");
  const Sizes sizes = ToSizes(GetUnchecked(group->GetProperty("Dimensions")));
  const std::size_t count = GetUnchecked(group->GetProperty("Displacements")).size();
  if (count == CountValues(sizes) || count == 0)
  {
    in.EditedSizes = sizes;
  }
  else if (ToSizes(GetUnchecked(editSizes)) == Sizes{ { 0, 0, 0 } } &&
    count == CountValues(in.EditedSizes))
  {
    SetUnchecked(editSizes, ToValues(in.EditedSizes));
  }
}

//-----------------------------------------------------------------------------
/// After an edit that was not made in the view: as if it had been.
void pqFFDLatticePropertyWidget::tellEdit(int changed)
{
  vtkAbstractWidget* widget = this->Internals->Widget;
  if (!changed || !widget)
  {
    this->scheduleShow();
    return;
  }
  widget->InvokeEvent(vtkCommand::StartInteractionEvent, nullptr);
  widget->InvokeEvent(vtkCommand::InteractionEvent, nullptr);
  widget->InvokeEvent(vtkCommand::EndInteractionEvent, nullptr);
  this->render();
}

//-----------------------------------------------------------------------------
void pqFFDLatticePropertyWidget::refine()
{
  const pqInternals& in = *this->Internals;
  for (QSpinBox* spin : in.Resolution)
  {
    // Knots in the middle of the cells: the shape stays as it is.
    const int finer = 2 * (spin->value() - 3) + 3;
    if (finer <= LargestSize)
    {
      spin->setValue(finer);
    }
  }
}

//-----------------------------------------------------------------------------
void pqFFDLatticePropertyWidget::resetEdits()
{
  if (Rep* rep = this->Internals->Representation)
  {
    this->tellEdit(rep->ResetEdits());
  }
}

//-----------------------------------------------------------------------------
void pqFFDLatticePropertyWidget::resetSelection()
{
  if (Rep* rep = this->Internals->Representation)
  {
    this->tellEdit(rep->ResetSelection());
  }
}

//-----------------------------------------------------------------------------
void pqFFDLatticePropertyWidget::movePoint(int i, int j, int k, double x, double y, double z)
{
  if (Rep* rep = this->Internals->Representation)
  {
    this->tellEdit(rep->SetControlPoint(i, j, k, x, y, z));
  }
}

//-----------------------------------------------------------------------------
void pqFFDLatticePropertyWidget::moveSelection()
{
  pqInternals& in = *this->Internals;
  double center[3];
  if (!in.Representation || !in.Representation->GetSelectionCenter(center))
  {
    return;
  }
  double move[3] = { 0.0, 0.0, 0.0 };
  for (std::size_t a = 0; a < 3; ++a)
  {
    double to = center[a];
    in.Center[a]->takeTyped(to);
    move[a] = to - center[a];
  }
  this->tellEdit(in.Representation->TranslateSelection(move[0], move[1], move[2]));
}
