// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkFFDInverseRayVolumeMapper_h
#define vtkFFDInverseRayVolumeMapper_h

#include "vtkFFDRenderingModule.h" // For export macro
#include "vtkVolumeMapper.h"

class VTKFFDRENDERING_EXPORT vtkFFDInverseRayVolumeMapper : public vtkVolumeMapper
{
public:
  static vtkFFDInverseRayVolumeMapper* New();
  vtkTypeMacro(vtkFFDInverseRayVolumeMapper, vtkVolumeMapper);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  void Render(vtkRenderer* ren, vtkVolume* vol) override;

protected:
  vtkFFDInverseRayVolumeMapper();
  ~vtkFFDInverseRayVolumeMapper() override;

private:
  vtkFFDInverseRayVolumeMapper(const vtkFFDInverseRayVolumeMapper&) = delete;
  void operator=(const vtkFFDInverseRayVolumeMapper&) = delete;
};

#endif
