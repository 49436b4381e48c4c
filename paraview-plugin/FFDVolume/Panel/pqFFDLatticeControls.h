// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef pqFFDLatticeControls_h
#define pqFFDLatticeControls_h

#include <QWidget>

#include <array>
#include <memory> // for std::unique_ptr

class QCheckBox;
class QGridLayout;
class QSpinBox;
class vtkFFDEditLatticeRepresentation;
class vtkSMProxy;

/**
 * The controls of the panel "Lattice": resolution, refinement and reset, and below them, each
 * folded away until it is opened, the selected points, the options of editing, and those of the
 * display.
 *
 * The controls show what the representation of the lattice has, where keys change options as well,
 * and tell by signals what the user wants; they change neither a property nor the lattice.
 */
class pqFFDLatticeControls : public QWidget
{
  Q_OBJECT
  typedef QWidget Superclass;

public:
  /// `representation` may be null.
  explicit pqFFDLatticeControls(
    vtkFFDEditLatticeRepresentation* representation, QWidget* parent = nullptr);
  ~pqFFDLatticeControls() override;

  QCheckBox* showLattice() const;
  const std::array<QSpinBox*, 3>& resolution() const;

  /// Show what the representation has; `bound` of the change of volume, too, which takes longer.
  void showState(bool bound);

  /// Opens the parts that have a control of which the text is a part of the name; those that it has
  /// opened before are closed if they have none.
  void search(const QString& text);

  /// Writes the controls' options to the properties of the widget.
  void writeOptions(vtkSMProxy* widget);

Q_SIGNALS:
  /// An option is another, of those that writeOptions() writes.
  void optionsChanged();
  /// Points were selected by a button.
  void selected();
  void refineAsked();
  /// Of the selected points, or of all edits if none or all are selected.
  void resetAsked();
  ///@{
  /// A control point, or the selection, is to be moved.
  void pointEdited(int i, int j, int k, double x, double y, double z);
  void selectionMoved(double x, double y, double z);
  ///@}

private Q_SLOTS:
  void moveSelection();

private:
  Q_DISABLE_COPY(pqFFDLatticeControls)

  QGridLayout* makeGroup(const char* name, const QString& text, const QString& help);
  void makeSelectionGroup();
  void makeEditingGroup();
  void makeDisplayGroup();

  class pqInternals;
  std::unique_ptr<pqInternals> Internals;
};

#endif
