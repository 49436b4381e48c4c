// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pqFFDLatticePropertyWidget.h"

#include "pqFFDLatticeControls.h"
#include "pqFFDPropertyValues.h"
#include "pqFFDServerCheck.h"

#include "vtkFFDEditLatticeRepresentation.h"
#include "vtkFFDLattice.h"
#include "vtkFFDLocalFrames.h"

#include "pqApplicationCore.h"
#include "pqCoreUtilities.h"
#include "pqPipelineSource.h"
#include "pqPropertiesPanel.h"
#include "pqPVApplicationCore.h"
#include "pqSearchBox.h"
#include "pqServerManagerModel.h"
#include "pqUndoStack.h"
#include "pqView.h"

#include "vtk3DWidgetRepresentation.h"
#include "vtkAbstractWidget.h"
#include "vtkCommand.h"
#include "vtkDoubleArray.h"
#include "vtkPVGeneralSettings.h"
#include "vtkSMProperty.h"
#include "vtkSMPropertyGroup.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMProxy.h"
#include "vtkSMTrace.h"
#include "vtkSMViewProxy.h"
#include "vtkWeakPointer.h"

#include <QAction>
#include <QApplication>
#include <QCheckBox>
#include <QKeyEvent>
#include <QLineEdit>
#include <QPointer>
#include <QSpinBox>
#include <QTimer>
#include <QVBoxLayout>

#include <vector>

namespace
{

using Rep = vtkFFDEditLatticeRepresentation;
using ffdpanel::GetChecked;
using ffdpanel::GetUnchecked;
using ffdpanel::SetChecked;
using ffdpanel::SetUnchecked;

/// The properties that an edit changes, by their functions.
const char* const EditedFunctions[] = { "Dimensions", "EditDimensions", "Displacements" };

/// Whether a key is the platform's for an edit, or that of ParaView's menu, which has another redo.
bool IsKeyOf(const QKeyEvent& key, QKeySequence::StandardKey edit, const char* menuAction)
{
  const QWidget* window = pqCoreUtilities::mainWidget();
  const QAction* action = window ? window->findChild<QAction*>(menuAction) : nullptr;
  const QKeySequence pressed(static_cast<int>(key.modifiers()) + key.key());
  return key.matches(edit) || (action && action->shortcut() == pressed);
}

} // namespace

//-----------------------------------------------------------------------------
class pqFFDLatticePropertyWidget::pqInternals
{
public:
  pqFFDLatticeControls* Controls = nullptr;
  QTimer ShowTimer;
  QTimer FinishTimer;
  QPointer<pqSearchBox> Search; // of the properties panel

  QPointer<pqProxy> Source;
  Rep* Representation = nullptr;
  vtkAbstractWidget* Widget = nullptr;
  vtkFFDLocalFrames Local; // of drags

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

  bool Away = false;          // the panel shows another source
  bool VisibleBefore = false; // whether the lattice was shown when it went
  bool Interacting = false;
  bool BaseIsOld = false; // the filter was updated in the middle of a drag
  bool Live = false;      // the filter has followed steps of the drag
  bool WasUnmodified = false;
  std::vector<std::vector<double>> Start; // values of EditedFunctions before the drag

  /// State of the panel before an edit that was not applied, or after one that was undone.
  struct Step
  {
    std::vector<std::vector<double>> Values; // unchecked, of EditedFunctions
    bool Unmodified = false;
  };
  Step Before; // the edit in progress
  std::vector<Step> UndoSteps;
  std::vector<Step> RedoSteps;
};

//-----------------------------------------------------------------------------
pqFFDLatticePropertyWidget::pqFFDLatticePropertyWidget(
  vtkSMProxy* smproxy, vtkSMPropertyGroup* smgroup, QWidget* parentObject)
  : Superclass("representations", "FFDLatticeWidgetRepresentation", smproxy, smgroup, parentObject)
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

  in.Controls = new pqFFDLatticeControls(in.Representation, this);
  in.Controls->setObjectName("Controls");
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(in.Controls);
  QCheckBox* show = in.Controls->showLattice();
  this->connect(show, SIGNAL(toggled(bool)), SLOT(setWidgetVisible(bool)));
  show->connect(this, SIGNAL(widgetVisibilityToggled(bool)), SLOT(setChecked(bool)));
  if (vtkSMProperty* resolution = smgroup->GetProperty("Dimensions"))
  {
    for (int a = 0; a < 3; ++a)
    {
      this->addPropertyLink(in.Controls->resolution()[static_cast<std::size_t>(a)], "value",
        SIGNAL(valueChanged(int)), resolution, a);
    }
  }
  this->connect(in.Controls, SIGNAL(optionsChanged()), SLOT(setOptions()));
  QObject::connect(
    in.Controls, &pqFFDLatticeControls::selected, this, [this]() { this->render(); });
  this->connect(in.Controls, SIGNAL(refineAsked()), SLOT(refine()));
  this->connect(in.Controls, SIGNAL(resetAsked()), SLOT(resetEdits()));
  this->connect(in.Controls, SIGNAL(pointEdited(int, int, int, double, double, double)),
    SLOT(movePoint(int, int, int, double, double, double)));
  this->connect(in.Controls, SIGNAL(selectionMoved(double, double, double)),
    SLOT(moveSelection(double, double, double)));
  this->setWidgetVisible(show->isChecked());

  for (QTimer* timer : { &in.ShowTimer, &in.FinishTimer })
  {
    timer->setSingleShot(true);
    timer->setInterval(0);
  }
  this->connect(&in.ShowTimer, SIGNAL(timeout()), SLOT(showState()));
  this->connect(&in.FinishTimer, SIGNAL(timeout()), SLOT(finishInteraction()));

  QObject::connect(this, &pqPropertyWidget::viewChanged, this, [this](pqView* view) {
    this->Internals->Local.SetView(
      view ? vtkSMViewProxy::SafeDownCast(view->getViewProxy()) : nullptr);
  });
  this->connect(this, SIGNAL(startInteraction()), SLOT(onStartInteraction()));
  this->connect(this, SIGNAL(interaction()), SLOT(onInteraction()));
  this->connect(this, SIGNAL(endInteraction()), SLOT(onEndInteraction()));
  if (in.Representation)
  {
    in.Observe(
      in.Representation, vtkCommand::SelectionChangedEvent, this, SLOT(onSelectionChanged()));
    in.Observe(in.Representation, vtkCommand::ModifiedEvent, this, SLOT(scheduleShow()));
  }
  for (const char* function : EditedFunctions)
  {
    if (vtkSMProperty* property = smgroup->GetProperty(function))
    {
      // By undo of ParaView, or a script: edits that were not applied are gone.
      in.Observe(property, vtkCommand::ModifiedEvent, this, SLOT(forgetSteps()));
    }
  }
  // ParaView names it by all the words that its search box finds it by.
  QObject::connect(this, &QObject::objectNameChanged, this, [this](const QString& name) {
    if (name.startsWith("FFDLattice:"))
    {
      this->setObjectName("FFDLattice");
    }
  });
  qApp->installEventFilter(this);
  if (auto* source = qobject_cast<pqPipelineSource*>(in.Source))
  {
    this->connect(source, SIGNAL(dataUpdated(pqPipelineSource*)), SLOT(takeBase()));
  }
  in.Observe(smgroup->GetProperty("Displacements"), vtkCommand::ModifiedEvent, this,
    SLOT(forgetEditedResolution()));
  this->nameEditedResolution();
  this->showState();
}

//-----------------------------------------------------------------------------
pqFFDLatticePropertyWidget::~pqFFDLatticePropertyWidget()
{
  qApp->removeEventFilter(this);
  // The superclass takes the widget out of the view, which is an event.
  QObject::disconnect(this, &pqPropertyWidget::viewChanged, this, nullptr);
  this->Internals->StopObserving();
}

//-----------------------------------------------------------------------------
void pqFFDLatticePropertyWidget::apply()
{
  this->forgetSteps();
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
  this->forgetSteps();
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
/**
 * The lattice goes with the panel and comes back as it was. The superclass does so, too, but looks
 * at the widget, which may be out of sight already, to know how it was. What is typed into the
 * search box of the panel hides and shows this widget alone: the lattice stays as it is.
 */
void pqFFDLatticePropertyWidget::hideEvent(QHideEvent* event)
{
  pqInternals& in = *this->Internals;
  this->pqPropertyWidget::hideEvent(event);
  if (!this->isHidden() && !in.Away)
  {
    in.Away = true;
    in.VisibleBefore = this->isWidgetVisible();
    this->setWidgetVisible(false);
  }
}

//-----------------------------------------------------------------------------
void pqFFDLatticePropertyWidget::showEvent(QShowEvent* event)
{
  pqInternals& in = *this->Internals;
  this->pqPropertyWidget::showEvent(event);
  this->findSearchBox();
  if (in.Away)
  {
    in.Away = false;
    this->setWidgetVisible(in.VisibleBefore);
  }
}

//-----------------------------------------------------------------------------
/// What is searched for may be in a part of the controls that is folded away.
void pqFFDLatticePropertyWidget::findSearchBox()
{
  pqInternals& in = *this->Internals;
  for (QWidget* above = this->parentWidget(); above && !in.Search; above = above->parentWidget())
  {
    auto* panel = qobject_cast<pqPropertiesPanel*>(above);
    in.Search = panel ? panel->findChild<pqSearchBox*>() : nullptr;
    if (in.Search)
    {
      QObject::connect(in.Search, &pqSearchBox::textChanged, in.Controls,
        [&in](const QString& text) { in.Controls->search(text); });
      in.Controls->search(in.Search->text());
    }
  }
}

//-----------------------------------------------------------------------------
void pqFFDLatticePropertyWidget::placeWidget() { this->takeBase(); }

//-----------------------------------------------------------------------------
/// Takes the displacements that the edits are added to from the filter.
void pqFFDLatticePropertyWidget::takeBase()
{
  pqInternals& in = *this->Internals;
  in.BaseIsOld = in.Interacting;
  if (in.Interacting)
  {
    return;
  }
  this->nameEditedResolution();
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
  copy("DataBounds", "OutlineBounds");
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
  in.Local.Begin(in.Representation);
  in.WasUnmodified = in.Source && in.Source->modifiedState() == pqProxy::UNMODIFIED;
  in.Before = { this->getUnchecked(), in.WasUnmodified };
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
    in.Local.Forget();
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
  if (!in.Interacting || pqFFDServerCheck::isLost(this->proxy()->GetSession()))
  {
    return;
  }
  in.Interacting = false;
  in.Local.End();
  const std::vector<std::vector<double>> values = this->getUnchecked();
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
  else if (values != in.Before.Values)
  {
    in.UndoSteps.push_back(in.Before);
    in.RedoSteps.clear();
  }
  if (in.BaseIsOld)
  {
    // The time that is shown, or a shape, may be another one since the drag began.
    this->takeBase();
  }
  this->scheduleShow();
}

//-----------------------------------------------------------------------------
std::vector<std::vector<double>> pqFFDLatticePropertyWidget::getUnchecked() const
{
  std::vector<std::vector<double>> values;
  for (const char* function : EditedFunctions)
  {
    values.push_back(GetUnchecked(this->propertyGroup()->GetProperty(function)));
  }
  return values;
}

//-----------------------------------------------------------------------------
void pqFFDLatticePropertyWidget::forgetSteps()
{
  this->Internals->UndoSteps.clear();
  this->Internals->RedoSteps.clear();
}

//-----------------------------------------------------------------------------
/**
 * ParaView's undo knows nothing of what is not applied yet, and would take back what was applied
 * before it: the keys for undo and redo are for those edits as long as there are any, and do
 * nothing in the middle of a drag.
 */
bool pqFFDLatticePropertyWidget::eventFilter(QObject* watched, QEvent* event)
{
  const bool asked = event->type() == QEvent::ShortcutOverride;
  if ((asked || event->type() == QEvent::KeyPress) && this->isSelected() && !this->Internals->Away)
  {
    auto* key = static_cast<QKeyEvent*>(event);
    const bool back = IsKeyOf(*key, QKeySequence::Undo, "actionEditUndo");
    const bool forth = IsKeyOf(*key, QKeySequence::Redo, "actionEditRedo");
    const auto& steps = back ? this->Internals->UndoSteps : this->Internals->RedoSteps;
    auto* line = qobject_cast<QLineEdit*>(QApplication::focusWidget());
    const bool ofText = line && (back ? line->isUndoAvailable() : line->isRedoAvailable());
    const bool dragging = this->Internals->Interacting;
    if ((back || forth) && (dragging || !steps.empty()) && !ofText)
    {
      event->accept();
      if (!asked && !dragging)
      {
        this->stepEdits(back);
      }
      return true;
    }
  }
  return this->Superclass::eventFilter(watched, event);
}

//-----------------------------------------------------------------------------
/// Undo, or redo, the last edit that was not applied.
void pqFFDLatticePropertyWidget::stepEdits(bool back)
{
  pqInternals& in = *this->Internals;
  std::vector<pqInternals::Step>& from = back ? in.UndoSteps : in.RedoSteps;
  std::vector<pqInternals::Step>& to = back ? in.RedoSteps : in.UndoSteps;
  const pqInternals::Step step = from.back();
  from.pop_back();
  to.push_back(
    { this->getUnchecked(), in.Source && in.Source->modifiedState() == pqProxy::UNMODIFIED });
  for (std::size_t n = 0; n < step.Values.size(); ++n)
  {
    SetUnchecked(this->propertyGroup()->GetProperty(EditedFunctions[n]), step.Values[n]);
  }
  if (in.Source)
  {
    in.Source->setModifiedState(step.Unmodified ? pqProxy::UNMODIFIED : pqProxy::MODIFIED);
  }
  this->render();
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
void pqFFDLatticePropertyWidget::scheduleShow() { this->Internals->ShowTimer.start(); }

//-----------------------------------------------------------------------------
/// Keys change options as well: show what is so, and tell the render server.
void pqFFDLatticePropertyWidget::showState()
{
  pqInternals& in = *this->Internals;
  if (in.Representation && !pqFFDServerCheck::isLost(this->proxy()->GetSession()))
  {
    in.Controls->showState(!in.Interacting);
    in.Controls->writeOptions(this->widgetProxy());
  }
}

//-----------------------------------------------------------------------------
/// Writes the controls' options to the widget and its copy on the render server.
void pqFFDLatticePropertyWidget::setOptions()
{
  this->Internals->Controls->writeOptions(this->widgetProxy());
  this->render();
}

//-----------------------------------------------------------------------------
/**
 * Edits by the widget say what resolution they are meant for. Those of scripts and of states may
 * not, which means that of the lattice: they say so, too, before that can become another one.
 */
void pqFFDLatticePropertyWidget::nameEditedResolution()
{
  vtkSMPropertyGroup* group = this->propertyGroup();
  vtkSMProperty* editSizes = group->GetProperty("EditDimensions");
  const std::vector<double> sizes = GetChecked(group->GetProperty("Dimensions"));
  const std::vector<double> edits = GetChecked(group->GetProperty("Displacements"));
  const double count = 3.0 * sizes[0] * sizes[1] * sizes[2];
  if (GetChecked(editSizes)[0] == 0.0 && static_cast<double>(edits.size()) == count)
  {
    SM_SCOPED_TRACE(PropertiesModified).arg("proxy", this->proxy());
    // Not pushed: the filter takes them as before.
    SetChecked(editSizes, sizes);
  }
}

//-----------------------------------------------------------------------------
/// Of edits that were not applied and that undo, a script or an animation has replaced.
void pqFFDLatticePropertyWidget::forgetEditedResolution()
{
  vtkSMProperty* editSizes = this->propertyGroup()->GetProperty("EditDimensions");
  SetUnchecked(editSizes, GetChecked(editSizes));
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
  for (QSpinBox* spin : this->Internals->Controls->resolution())
  {
    // Knots in the middle of the cells: the shape stays as it is.
    const int finer = 2 * (spin->value() - 3) + 3;
    if (finer <= spin->maximum())
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
    const vtkIdType count = rep->GetNumberOfSelectedPoints();
    const bool some = count > 0 && count < rep->GetLattice()->GetNumberOfControlPoints();
    this->tellEdit(some ? rep->ResetSelection() : rep->ResetEdits());
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
void pqFFDLatticePropertyWidget::moveSelection(double x, double y, double z)
{
  if (Rep* rep = this->Internals->Representation)
  {
    this->tellEdit(rep->TranslateSelection(x, y, z));
  }
}
