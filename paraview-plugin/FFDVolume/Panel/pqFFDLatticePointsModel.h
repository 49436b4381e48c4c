// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef pqFFDLatticePointsModel_h
#define pqFFDLatticePointsModel_h

#include <QAbstractTableModel>

#include <array>
#include <vector>

class vtkFFDLatticeRepresentation;

/**
 * The selected control points of a lattice as a table: a row each, its indices as the header of the
 * row, and the three coordinates. A number that the user types in is passed on by pointEdited() and
 * shown once the lattice has changed.
 */
class pqFFDLatticePointsModel : public QAbstractTableModel
{
  Q_OBJECT
  typedef QAbstractTableModel Superclass;

public:
  explicit pqFFDLatticePointsModel(QObject* parent = nullptr);
  ~pqFFDLatticePointsModel() override;

  /// Show the points that are selected now, where they are now.
  void update(vtkFFDLatticeRepresentation* representation);

  int rowCount(const QModelIndex& parent = QModelIndex()) const override;
  int columnCount(const QModelIndex& parent = QModelIndex()) const override;
  QVariant data(const QModelIndex& index, int role) const override;
  bool setData(const QModelIndex& index, const QVariant& value, int role) override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;
  Qt::ItemFlags flags(const QModelIndex& index) const override;

Q_SIGNALS:
  /// The user wants control point (i, j, k) at another place.
  void pointEdited(int i, int j, int k, double x, double y, double z);

private:
  Q_DISABLE_COPY(pqFFDLatticePointsModel)

  struct Row
  {
    std::array<int, 3> Indices;
    std::array<double, 3> Position;
  };
  std::vector<Row> Rows;
};

#endif
