// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkFFDDeformVolume_h
#define vtkFFDDeformVolume_h

#include "vtkFFDFiltersModule.h" // For export macro
#include "vtkImageAlgorithm.h"

class VTKFFDFILTERS_EXPORT vtkFFDDeformVolume : public vtkImageAlgorithm
{
public:
  static vtkFFDDeformVolume* New();
  vtkTypeMacro(vtkFFDDeformVolume, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

protected:
  vtkFFDDeformVolume();
  ~vtkFFDDeformVolume() override;

private:
  vtkFFDDeformVolume(const vtkFFDDeformVolume&) = delete;
  void operator=(const vtkFFDDeformVolume&) = delete;
};

#endif
