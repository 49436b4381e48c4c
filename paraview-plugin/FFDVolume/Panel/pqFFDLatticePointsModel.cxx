// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pqFFDLatticePointsModel.h"

#include "vtkFFDLattice.h"
#include "vtkFFDLatticeRepresentation.h"

#include "vtkIdTypeArray.h"
#include "vtkNew.h"

#include <QLocale>

#include <cmath>

//-----------------------------------------------------------------------------
pqFFDLatticePointsModel::pqFFDLatticePointsModel(QObject* parentObject)
  : Superclass(parentObject)
{
}

//-----------------------------------------------------------------------------
pqFFDLatticePointsModel::~pqFFDLatticePointsModel() = default;

//-----------------------------------------------------------------------------
void pqFFDLatticePointsModel::update(vtkFFDLatticeRepresentation* representation)
{
  vtkFFDLattice* lattice = representation->GetLattice();
  const int* sizes = lattice->GetDimensions();
  vtkNew<vtkIdTypeArray> points;
  representation->GetSelectedPoints(points);
  std::vector<Row> rows(static_cast<std::size_t>(points->GetNumberOfValues()));
  bool same = rows.size() == this->Rows.size();
  for (std::size_t n = 0; n < rows.size(); ++n)
  {
    const auto point = static_cast<int>(points->GetValue(static_cast<vtkIdType>(n)));
    Row& row = rows[n];
    row.Indices = { { point % sizes[0], point / sizes[0] % sizes[1],
      point / (sizes[0] * sizes[1]) } };
    lattice->GetControlPoint(row.Indices[0], row.Indices[1], row.Indices[2], row.Position.data());
    same = same && row.Indices == this->Rows[n].Indices;
  }
  if (!same)
  {
    this->beginResetModel();
    this->Rows = std::move(rows);
    this->endResetModel();
  }
  else if (!rows.empty())
  {
    this->Rows = std::move(rows);
    Q_EMIT this->dataChanged(
      this->index(0, 0), this->index(this->rowCount() - 1, this->columnCount() - 1));
  }
}

//-----------------------------------------------------------------------------
int pqFFDLatticePointsModel::rowCount(const QModelIndex& parentIndex) const
{
  return parentIndex.isValid() ? 0 : static_cast<int>(this->Rows.size());
}

//-----------------------------------------------------------------------------
int pqFFDLatticePointsModel::columnCount(const QModelIndex& parentIndex) const
{
  return parentIndex.isValid() ? 0 : 3;
}

//-----------------------------------------------------------------------------
QVariant pqFFDLatticePointsModel::data(const QModelIndex& where, int role) const
{
  if (!where.isValid() || (role != Qt::DisplayRole && role != Qt::EditRole))
  {
    return QVariant();
  }
  const double value = this->Rows[static_cast<std::size_t>(where.row())]
                         .Position[static_cast<std::size_t>(where.column())];
  // As text, for a spin box would cut the digits.
  return role == Qt::EditRole ? QString::number(value, 'g', 15) : QString::number(value, 'g', 6);
}

//-----------------------------------------------------------------------------
bool pqFFDLatticePointsModel::setData(const QModelIndex& where, const QVariant& value, int role)
{
  bool isNumber = false;
  const double number = value.toDouble(&isNumber);
  if (!where.isValid() || role != Qt::EditRole || !isNumber || !std::isfinite(number))
  {
    return false;
  }
  const Row row = this->Rows[static_cast<std::size_t>(where.row())];
  std::array<double, 3> to = row.Position;
  to[static_cast<std::size_t>(where.column())] = number;
  if (to != row.Position)
  {
    Q_EMIT this->pointEdited(row.Indices[0], row.Indices[1], row.Indices[2], to[0], to[1], to[2]);
  }
  return true;
}

//-----------------------------------------------------------------------------
QVariant pqFFDLatticePointsModel::headerData(
  int section, Qt::Orientation orientation, int role) const
{
  if (role != Qt::DisplayRole)
  {
    return QVariant();
  }
  if (orientation == Qt::Horizontal)
  {
    return QString(QChar('X' + section));
  }
  const std::array<int, 3>& at = this->Rows[static_cast<std::size_t>(section)].Indices;
  return QString("%1, %2, %3").arg(at[0]).arg(at[1]).arg(at[2]);
}

//-----------------------------------------------------------------------------
Qt::ItemFlags pqFFDLatticePointsModel::flags(const QModelIndex& where) const
{
  return where.isValid() ? Qt::ItemIsEnabled | Qt::ItemIsSelectable | Qt::ItemIsEditable
                         : Qt::NoItemFlags;
}
