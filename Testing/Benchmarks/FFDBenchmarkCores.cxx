// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDBenchmarkCores.h"

#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDLattice.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkSMPTools.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

namespace ffdBenchmark
{

namespace
{

struct KeptCores
{
  explicit KeptCores(vtkImageData* image, int size)
    : View(size, image)
  {
  }
  Stage View;
  vtkNew<vtkImageData> Picture;
};

} // namespace

//------------------------------------------------------------------------------
std::vector<std::string> GetThreadCounts()
{
  const int all = vtkSMPTools::GetEstimatedNumberOfThreads();
  std::vector<std::string> counts;
  for (int count = 1; count < all; count *= 2)
  {
    counts.push_back(std::to_string(count));
  }
  counts.push_back(std::to_string(all));
  return counts;
}

//------------------------------------------------------------------------------
std::shared_ptr<void> PrepareCores(Group& group, const std::string& folder, Opacity opacity,
  int size, const Deformation& deformation, bool edited)
{
  const auto image = ReadVolume(folder, "engine");
  auto kept = std::make_shared<KeptCores>(image, size);
  KeptCores* const k = kept.get();
  const auto property = MakeProperty(opacity);
  for (Row& row : group.GetRows())
  {
    vtkSmartPointer<vtkFFDLattice> lattice;
    if (deformation.Form != Shape::Identity)
    {
      lattice = vtkSmartPointer<vtkFFDLattice>::New();
      Deform(lattice, image, deformation);
    }
    const auto mapper = MakeMapper(image, lattice, Variant::Exact);
    mapper->SetNumberOfThreads(std::stoi(row.Name));
    vtkVolume* const volume = k->View.AddVolume(mapper, property);
    row.Run = [k, mapper, volume, size, lattice, edited, step = 0]() mutable {
      if (edited)
      {
        constexpr int dragged = 4;
        double d[3];
        lattice->GetDisplacement(dragged, dragged, dragged, d);
        lattice->SetDisplacement(
          dragged, dragged, dragged, d[0] + (++step % 2 == 0 ? -1.0 : 1.0), d[1], d[2]);
      }
      mapper->RenderToImage(k->View.GetRenderer(), volume, size, size, k->Picture);
    };
    row.Run();
    double range[2];
    k->Picture->GetPointData()->GetScalars()->GetRange(range, -1);
    if (!(range[1] > 0.0))
    {
      row.Refusal = "the picture is empty";
    }
  }
  return kept;
}

} // namespace ffdBenchmark
