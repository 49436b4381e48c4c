// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pqFFDLatticeControls.h"

#include "pqFFDLatticePointsModel.h"

#include "vtkFFDEditLatticeRepresentation.h"
#include "vtkFFDLattice.h"

#include "pqPropertiesPanel.h"

#include "vtkSMPropertyHelper.h"
#include "vtkSMProxy.h"

#include <QCheckBox>
#include <QComboBox>
#include <QDoubleValidator>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSpinBox>
#include <QStyle>
#include <QTableView>
#include <QToolButton>
#include <QVBoxLayout>

#include <algorithm>
#include <vector>

namespace
{

using Rep = vtkFFDEditLatticeRepresentation;

constexpr int LargestSize = 64;

/// The panel is a narrow one: what its widgets can be made to, pixels.
constexpr int NarrowWidth = 44;

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

/// Add a line to a group; without a label the widgets take all of it.
void AddLine(QGridLayout* group, const QString& label, const QList<QWidget*>& widgets)
{
  const int line = group->rowCount();
  auto* row = new QHBoxLayout();
  for (QWidget* widget : widgets)
  {
    widget->setMinimumWidth(NarrowWidth);
    row->addWidget(widget, 1);
  }
  if (label.isEmpty())
  {
    group->addLayout(row, line, 0, 1, 2);
    return;
  }
  auto* text = new QLabel(label, group->parentWidget());
  text->setToolTip(widgets.front()->toolTip());
  group->addWidget(text, line, 0);
  group->addLayout(row, line, 1);
}

} // namespace

//-----------------------------------------------------------------------------
class pqFFDLatticeControls::pqInternals
{
public:
  Rep* Representation = nullptr;
  QVBoxLayout* Layout = nullptr;
  QCheckBox* ShowLattice = nullptr;
  std::array<QSpinBox*, 3> Resolution{};
  QPushButton* Reset = nullptr;
  QLabel* Volume = nullptr;

  QLabel* Selected = nullptr;
  std::array<NumberEdit*, 3> Center{};
  pqFFDLatticePointsModel* Points = nullptr;

  /// A part of the panel, and the button that opens it.
  struct Group
  {
    QToolButton* Toggle;
    QWidget* Body;
    bool OpenedBySearch;
  };
  std::vector<Group> Groups;

  QComboBox* Handle = nullptr;
  QComboBox* Constraint = nullptr;
  QCheckBox* Soft = nullptr;
  NumberEdit* Radius = nullptr;
  QComboBox* Falloff = nullptr;
  std::array<QCheckBox*, 3> Symmetry{};
  QCheckBox* Lock = nullptr;
  QComboBox* FoldGuard = nullptr;

  QCheckBox* Interior = nullptr;
  QCheckBox* Curved = nullptr;
};

//-----------------------------------------------------------------------------
pqFFDLatticeControls::pqFFDLatticeControls(
  vtkFFDEditLatticeRepresentation* representation, QWidget* parentWidget)
  : Superclass(parentWidget)
  , Internals(new pqInternals())
{
  pqInternals& in = *this->Internals;
  in.Representation = representation;
  in.Layout = new QVBoxLayout(this);
  in.Layout->setContentsMargins(0, 0, 0, 0);
  in.Layout->setSpacing(pqPropertiesPanel::suggestedVerticalSpacing());

  in.ShowLattice = MakeCheck(this, "show3DWidget", tr("Show Lattice"),
    tr("Show the lattice in the view. Drag control points; click selects, shift and click adds, "
       "shift and drag selects a rectangle. Keys x, y, z constrain to an axis, a selects all, "
       "g, r, s choose the handle."));
  in.ShowLattice->setChecked(true);
  in.Layout->addWidget(in.ShowLattice);

  auto* sizes = new QHBoxLayout();
  auto* sizesLabel = new QLabel(tr("Resolution"), this);
  sizes->addWidget(sizesLabel);
  for (std::size_t a = 0; a < 3; ++a)
  {
    auto* spin = new QSpinBox(this);
    spin->setObjectName(QString("Resolution_%1").arg(a));
    spin->setRange(4, LargestSize);
    spin->setKeyboardTracking(false);
    spin->setMinimumWidth(NarrowWidth);
    spin->setToolTip(tr("Control points along each axis. A change keeps what was edited."));
    sizesLabel->setToolTip(spin->toolTip());
    in.Resolution[a] = spin;
    sizes->addWidget(spin, 1);
  }
  in.Layout->addLayout(sizes);

  auto* refine = new QPushButton(tr("Refine"), this);
  refine->setObjectName("Refine");
  refine->setToolTip(tr("Twice as many cells along each axis, and the same displacements."));
  QObject::connect(refine, &QPushButton::clicked, this, [this]() { Q_EMIT this->refineAsked(); });
  in.Reset = new QPushButton(
    this->style()->standardIcon(QStyle::SP_DialogResetButton), tr("Reset All Edits"), this);
  in.Reset->setObjectName("Reset");
  in.Reset->setToolTip(tr(
    "The selected control points back to rest (Delete); with none selected, take back all that was "
    "dragged or typed in. Shape and lattice of the input stay."));
  QObject::connect(in.Reset, &QPushButton::clicked, this, [this]() { Q_EMIT this->resetAsked(); });
  auto* buttons = new QHBoxLayout();
  for (QPushButton* button : { refine, in.Reset })
  {
    button->setMinimumWidth(NarrowWidth);
    buttons->addWidget(button, button == in.Reset ? 2 : 1);
  }
  in.Layout->addLayout(buttons);

  in.Volume = new QLabel(this);
  in.Volume->setObjectName("VolumeChange");
  in.Volume->setWordWrap(true);
  in.Volume->setToolTip(
    tr("Proven lower bound of the local change of volume. The lattice folds only if it is not "
       "positive."));
  in.Layout->addWidget(in.Volume);

  this->makeSelectionGroup();
  this->makeEditingGroup();
  this->makeDisplayGroup();

  for (QComboBox* choice : { in.Handle, in.Constraint, in.Falloff, in.FoldGuard })
  {
    this->connect(choice, SIGNAL(currentIndexChanged(int)), SIGNAL(optionsChanged()));
  }
  for (QCheckBox* check :
    { in.Soft, in.Symmetry[0], in.Symmetry[1], in.Symmetry[2], in.Lock, in.Interior, in.Curved })
  {
    this->connect(check, SIGNAL(toggled(bool)), SIGNAL(optionsChanged()));
  }
  this->connect(in.Radius, SIGNAL(editingFinished()), SIGNAL(optionsChanged()));
}

//-----------------------------------------------------------------------------
pqFFDLatticeControls::~pqFFDLatticeControls() = default;

//-----------------------------------------------------------------------------
QCheckBox* pqFFDLatticeControls::showLattice() const { return this->Internals->ShowLattice; }

//-----------------------------------------------------------------------------
const std::array<QSpinBox*, 3>& pqFFDLatticeControls::resolution() const
{
  return this->Internals->Resolution;
}

//-----------------------------------------------------------------------------
/// A part of the panel below a button that opens it. Its widget has the name, the button
/// "<name>Toggle".
QGridLayout* pqFFDLatticeControls::makeGroup(
  const char* name, const QString& text, const QString& help)
{
  auto* toggle = new QToolButton(this);
  toggle->setObjectName(QString(name) + "Toggle");
  toggle->setText(text);
  toggle->setToolTip(help);
  toggle->setCheckable(true);
  toggle->setAutoRaise(true);
  toggle->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
  toggle->setArrowType(Qt::RightArrow);
  toggle->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
  auto* body = new QWidget(this);
  body->setObjectName(name);
  body->hide();
  QObject::connect(toggle, &QToolButton::toggled, body, [toggle, body](bool open) {
    toggle->setArrowType(open ? Qt::DownArrow : Qt::RightArrow);
    body->setVisible(open);
  });
  auto* grid = new QGridLayout(body);
  grid->setContentsMargins(0, 0, 0, 0);
  grid->setHorizontalSpacing(pqPropertiesPanel::suggestedHorizontalSpacing());
  grid->setVerticalSpacing(pqPropertiesPanel::suggestedVerticalSpacing());
  grid->setColumnStretch(1, 1);
  this->Internals->Layout->addWidget(toggle);
  this->Internals->Layout->addWidget(body);
  this->Internals->Groups.push_back({ toggle, body, false });
  return grid;
}

//-----------------------------------------------------------------------------
void pqFFDLatticeControls::search(const QString& text)
{
  for (pqInternals::Group& group : this->Internals->Groups)
  {
    QStringList names{ group.Toggle->text() };
    for (const QWidget* each : group.Body->findChildren<QWidget*>())
    {
      names << each->objectName() << each->property("text").toString();
    }
    const QString words = QString(text).remove(' ');
    const bool found = !words.isEmpty() &&
      !names.replaceInStrings(" ", "").filter(words, Qt::CaseInsensitive).isEmpty();
    if (found != group.OpenedBySearch && (!found || !group.Toggle->isChecked()))
    {
      group.Toggle->setChecked(found);
      group.OpenedBySearch = found;
    }
  }
}

//-----------------------------------------------------------------------------
void pqFFDLatticeControls::makeSelectionGroup()
{
  pqInternals& in = *this->Internals;
  QGridLayout* group = this->makeGroup("SelectionGroup", tr("Selected Points"),
    tr("Which control points are selected, and where they are."));
  QWidget* body = group->parentWidget();

  const auto makeSelector = [this, body](const char* name, const QString& text, const QString& help,
                              void (Rep::*method)()) -> QWidget* {
    auto* button = new QToolButton(body);
    button->setText(text);
    button->setObjectName(name);
    button->setToolTip(help);
    button->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
    QObject::connect(button, &QToolButton::clicked, this, [this, method]() {
      if (Rep* representation = this->Internals->Representation)
      {
        (representation->*method)();
        Q_EMIT this->selected();
      }
    });
    return button;
  };
  AddLine(group, QString(),
    { makeSelector("SelectAll", tr("All"), tr("Select all control points (a)"), &Rep::SelectAll),
      makeSelector("SelectNone", tr("None"), tr("Select none (A)"), &Rep::ClearSelection),
      makeSelector(
        "InvertSelection", tr("Invert"), tr("Select the others (I)"), &Rep::InvertSelection) });
  AddLine(group, QString(),
    { makeSelector("GrowSelection", tr("Grow"), tr("Add the neighbors (+)"), &Rep::GrowSelection),
      makeSelector("ShrinkSelection", tr("Shrink"), tr("Leave the outermost ones out (-)"),
        &Rep::ShrinkSelection) });

  in.Selected = new QLabel(body);
  in.Selected->setWordWrap(true);
  in.Selected->setObjectName("SelectedPoints");
  in.Selected->setToolTip(
    tr("Click a control point in the view to select it; shift and click adds others, shift and "
       "drag those in a rectangle."));
  AddLine(group, QString(), { in.Selected });
  QList<QWidget*> row;
  for (std::size_t a = 0; a < 3; ++a)
  {
    in.Center[a] = new NumberEdit(body, QString("Center_%1").arg(a),
      tr("Center of the selected control points; a new one moves them all."));
    this->connect(in.Center[a], SIGNAL(editingFinished()), SLOT(moveSelection()));
    row << in.Center[a];
  }
  AddLine(group, tr("Center"), row);

  in.Points = new pqFFDLatticePointsModel(this);
  auto* table = new QTableView(body);
  table->setObjectName("Points");
  table->setModel(in.Points);
  table->setToolTip(tr("Positions of the selected control points. Double click to change one."));
  table->horizontalHeader()->setSectionResizeMode(QHeaderView::Stretch);
  const int height = table->fontMetrics().height() + 6;
  table->verticalHeader()->setDefaultSectionSize(height);
  table->setMinimumHeight(6 * height);
  table->setMaximumHeight(8 * height);
  AddLine(group, QString(), { table });
  this->connect(in.Points, SIGNAL(pointEdited(int, int, int, double, double, double)),
    SIGNAL(pointEdited(int, int, int, double, double, double)));
}

//-----------------------------------------------------------------------------
void pqFFDLatticeControls::makeEditingGroup()
{
  pqInternals& in = *this->Internals;
  QGridLayout* group = this->makeGroup(
    "EditingGroup", tr("Editing"), tr("How control points are dragged, and what follows them."));
  QWidget* body = group->parentWidget();
  in.Handle = MakeChoice(body, "Handle", { tr("Move"), tr("Turn"), tr("Scale"), tr("None") },
    { Rep::HANDLE_TRANSLATE, Rep::HANDLE_ROTATE, Rep::HANDLE_SCALE, Rep::HANDLE_OFF },
    tr("The handle of the selection (g, r, s)"));
  in.Constraint = MakeChoice(body, "Constraint",
    { tr("Free"), tr("X axis"), tr("Y axis"), tr("Z axis"), tr("YZ plane"), tr("XZ plane"),
      tr("XY plane") },
    { Rep::FREE, Rep::ALONG_X, Rep::ALONG_Y, Rep::ALONG_Z, Rep::ACROSS_X, Rep::ACROSS_Y,
      Rep::ACROSS_Z },
    tr("What drags keep to (x, y, z; with shift the plane across the axis)"));
  AddLine(group, tr("Handle"), { in.Handle });
  AddLine(group, tr("Constraint"), { in.Constraint });

  in.Soft =
    MakeCheck(body, "SoftEditing", tr("Soft"), tr("Control points near the selection follow (o)"));
  in.Radius = new NumberEdit(body, "SoftRadius",
    tr("How far soft editing reaches, in units of the data; 0: two control points far. "
       "The mouse wheel over a control point changes it, too."));
  in.Falloff = MakeChoice(body, "Falloff",
    { tr("Smooth"), tr("Linear"), tr("Sphere"), tr("Sharp"), tr("Constant") },
    { Rep::SMOOTH, Rep::LINEAR, Rep::SPHERE, Rep::SHARP, Rep::CONSTANT },
    tr("How soft editing fades with the distance (O)"));
  AddLine(group, tr("Neighbors"), { in.Soft, in.Falloff });
  AddLine(group, tr("Radius"), { in.Radius });

  QList<QWidget*> row;
  for (std::size_t a = 0; a < 3; ++a)
  {
    const QString axis(QChar('X' + static_cast<int>(a)));
    in.Symmetry[a] = MakeCheck(body, qPrintable("Symmetry" + axis), axis,
      tr("Edits are mirrored across the middle of this axis (m)"));
    row << in.Symmetry[a];
  }
  AddLine(group, tr("Symmetry"), row);
  in.FoldGuard = MakeChoice(body, "FoldGuard", { tr("Off"), tr("Stop Edits"), tr("Warn") },
    { Rep::GUARD_OFF, Rep::GUARD_CLAMP, Rep::GUARD_WARN },
    tr("What to do about edits that fold the volume: nothing, stop there, or show the lattice in "
       "red (v)"));
  AddLine(group, tr("Folds"), { in.FoldGuard });
  in.Lock = MakeCheck(body, "LockBoundary", tr("Locked"),
    tr("The three outermost layers of control points stay, so that the faces of the lattice do "
       "(l)"));
  AddLine(group, tr("Boundary"), { in.Lock });
}

//-----------------------------------------------------------------------------
void pqFFDLatticeControls::makeDisplayGroup()
{
  pqInternals& in = *this->Internals;
  QGridLayout* group =
    this->makeGroup("DisplayGroup", tr("Display"), tr("What is shown of the lattice."));
  QWidget* body = group->parentWidget();
  in.Interior =
    MakeCheck(body, "InteriorPoints", tr("Interior"), tr("Show the control points inside, too"));
  in.Curved = MakeCheck(body, "CurvedLines", tr("Curved"),
    tr("Show what the grid lines of the lattice become, not the lines between control points"));
  AddLine(group, QString(), { in.Interior, in.Curved });
}

//-----------------------------------------------------------------------------
void pqFFDLatticeControls::showState(bool bound)
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
  in.Reset->setText(count > 0 && count < rep->GetLattice()->GetNumberOfControlPoints()
      ? tr("Reset %1 Selected").arg(count)
      : tr("Reset All Edits"));
  in.Points->update(rep);
  if (bound)
  {
    const double change = rep->GetLattice()->GetMinimumJacobianBound();
    in.Volume->setText(change > 0.0
        ? tr("Volume changes locally by a factor of %1 at least.").arg(change, 0, 'g', 3)
        : tr("The lattice may fold (bound of the change of volume: %1).").arg(change, 0, 'g', 3));
  }
}

//-----------------------------------------------------------------------------
void pqFFDLatticeControls::writeOptions(vtkSMProxy* widget)
{
  pqInternals& in = *this->Internals;
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
}

//-----------------------------------------------------------------------------
void pqFFDLatticeControls::moveSelection()
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
  Q_EMIT this->selectionMoved(move[0], move[1], move[2]);
}
