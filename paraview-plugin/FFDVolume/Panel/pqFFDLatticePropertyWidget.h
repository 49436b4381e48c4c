// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef pqFFDLatticePropertyWidget_h
#define pqFFDLatticePropertyWidget_h

#include "pqInteractivePropertyWidget.h"

#include <memory> // for std::unique_ptr
#include <vector> // for std::vector

/**
 * The panel "Lattice" of the filter FFD Lattice, and the lattice widget in the view.
 *
 * The properties of the group, by their functions: "Dimensions" (Resolution), "Displacements" and
 * "EditDimensions" (DisplacementsResolution) of the filter; "Input", its input. The widget shows
 * the displacements on top of what the filter adds them to, which it asks the filter for.
 *
 * Edits change unchecked values, which Apply accepts, as it does everywhere in ParaView. With
 * auto-apply the filter follows each step of a drag; the drag as a whole is then one step of
 * ParaView's undo. Edits that are not applied yet are undone and redone here, by the same keys.
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
  bool eventFilter(QObject* watched, QEvent* event) override;

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
  void takeBase();
  void setOptions();
  void refine();
  void resetEdits();
  void forgetSteps();
  void forgetEditedResolution();
  void movePoint(int i, int j, int k, double x, double y, double z);
  void moveSelection(double x, double y, double z);

private:
  Q_DISABLE_COPY(pqFFDLatticePropertyWidget)

  void findSearchBox();
  void tellEdit(int changed);
  void nameEditedResolution();
  std::vector<std::vector<double>> getUnchecked() const;
  void stepEdits(bool back);

  class pqInternals;
  std::unique_ptr<pqInternals> Internals;
};

#endif
