// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDContentTime.h"

#include "vtkCellData.h"
#include "vtkDataSet.h"
#include "vtkInformation.h"
#include "vtkInformationIdTypeKey.h"
#include "vtkPointData.h"

#include <algorithm>

namespace
{

/// Modification time of the content that was passed on, and of the output when that was noted.
vtkInformationIdTypeKey* SourceTimeKey()
{
  static vtkInformationIdTypeKey* const key =
    vtkInformationIdTypeKey::MakeKey("SOURCE_TIME", "vtkFFDContentTime");
  return key;
}
vtkInformationIdTypeKey* OwnTimeKey()
{
  static vtkInformationIdTypeKey* const key =
    vtkInformationIdTypeKey::MakeKey("OWN_TIME", "vtkFFDContentTime");
  return key;
}

vtkMTimeType OwnTime(vtkDataSet* data)
{
  return std::max({ data->vtkObject::GetMTime(), data->GetPointData()->GetMTime(),
    data->GetCellData()->GetMTime() });
}

} // namespace

//------------------------------------------------------------------------------
vtkMTimeType vtkFFDGetContentTime(vtkDataSet* data)
{
  const vtkMTimeType own = OwnTime(data);
  vtkInformation* information = data->GetInformation();
  const bool passed = information->Has(OwnTimeKey()) && information->Has(SourceTimeKey()) &&
    static_cast<vtkMTimeType>(information->Get(OwnTimeKey())) == own;
  return passed ? static_cast<vtkMTimeType>(information->Get(SourceTimeKey())) : own;
}

//------------------------------------------------------------------------------
void vtkFFDPassContentTime(vtkDataSet* input, vtkDataSet* output)
{
  const vtkMTimeType source = vtkFFDGetContentTime(input);
  output->GetInformation()->Set(SourceTimeKey(), static_cast<vtkIdType>(source));
  output->GetInformation()->Set(OwnTimeKey(), static_cast<vtkIdType>(OwnTime(output)));
}
