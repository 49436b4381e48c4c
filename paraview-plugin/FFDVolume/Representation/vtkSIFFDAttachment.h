// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkSIFFDAttachment
 * @brief   gives ParaView's own objects what lattices need
 *
 * The definitions of the plugin add a property of this class to ParaView's representations and
 * exporters. It has no value: where an object is made, in all processes, it is made to show what a
 * lattice moves (vtkFFDShownGeometry::Follow()), or to warn of what is not exported.
 */
#ifndef vtkSIFFDAttachment_h
#define vtkSIFFDAttachment_h

#include "vtkFFDParaViewModule.h" // For export macro
#include "vtkSIProperty.h"

class VTKFFDPARAVIEW_EXPORT vtkSIFFDAttachment : public vtkSIProperty
{
public:
  static vtkSIFFDAttachment* New();
  vtkTypeMacro(vtkSIFFDAttachment, vtkSIProperty);
  void PrintSelf(ostream& os, vtkIndent indent) override;

protected:
  vtkSIFFDAttachment();
  ~vtkSIFFDAttachment() override;

  bool ReadXMLAttributes(vtkSIProxy* proxy, vtkPVXMLElement* element) override;
  bool Push(vtkSMMessage*, int) override { return true; }
  bool Pull(vtkSMMessage*) override { return true; }

private:
  vtkSIFFDAttachment(const vtkSIFFDAttachment&) = delete;
  void operator=(const vtkSIFFDAttachment&) = delete;
};

#endif
