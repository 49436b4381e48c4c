// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef pqFFDLatticePropertyWidget_h
#define pqFFDLatticePropertyWidget_h

#include "pqInteractivePropertyWidget.h"

#include <memory> // for std::unique_ptr

/**
 * The panel "Lattice" of the filter FFD Lattice, and the lattice widget in the view.
 *
 * The properties of the group, by their functions: "Dimensions" (Resolution), "Displacements" and
 * "EditDimensions" (DisplacementsResolution) of the filter; "Input", its input. The widget shows
 * the displacements on top of what the filter adds them to, which it asks the filter for.
 *
 * Edits change unchecked values, which Apply accepts, as it does everywhere in ParaView. With
 * auto-apply the filter follows each step of a drag; the drag as a whole is then one step of
 * ParaView's undo.
 */
class pqFFDLatticePropertyWidget : public pqInteractivePropertyWidget
{
  Q_OBJECT
  typedef pqInteractivePropertyWidget Superclass;

public:
  pqFFDLatticePropertyWidget(
    vtkSMProxy* proxy, vtkSMPropertyGroup* group, QWidget* parent = nullptr);
  ~pqFFDLatticePropertyWidget() override;

  void apply() override;
  void reset() override;

protected:
  void hideEvent(QHideEvent* event) override;
  void showEvent(QShowEvent* event) override;

protected Q_SLOTS:
  void placeWidget() override;

private Q_SLOTS:
  void onStartInteraction();
  void onInteraction();
  void onEndInteraction();
  void finishInteraction();
  void onSelectionChanged();
  void scheduleShow();
  void showState();
  void scheduleSettle();
  void settleResolution();
  void takeBase();
  void setOptions();
  void refine();
  void resetEdits();
  void resetSelection();
  void movePoint(int i, int j, int k, double x, double y, double z);
  void moveSelection();

private:
  Q_DISABLE_COPY(pqFFDLatticePropertyWidget)

  void makeControls();
  void tellEdit(int changed);

  class pqInternals;
  std::unique_ptr<pqInternals> Internals;
};

#endif
