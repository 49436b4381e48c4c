// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSIFFDTuples.h"

#include "vtkClientServerStream.h"
#include "vtkDoubleArray.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkSMMessage.h"

#include <algorithm>

vtkStandardNewMacro(vtkSIFFDTuples);

//------------------------------------------------------------------------------
vtkSIFFDTuples::vtkSIFFDTuples() = default;

//------------------------------------------------------------------------------
vtkSIFFDTuples::~vtkSIFFDTuples() = default;

//------------------------------------------------------------------------------
void vtkSIFFDTuples::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}

//------------------------------------------------------------------------------
bool vtkSIFFDTuples::Push(vtkSMMessage* message, int offset)
{
  if (this->InformationOnly || !this->Command)
  {
    return this->Superclass::Push(message, offset);
  }
  this->SaveValueToCache(message, offset);
  const Variant& given = message->GetExtension(ProxyState::property, offset).value();
  const int components = std::max(1, this->GetNumberOfElementsPerCommand());
  const int tuples = given.float64_size() / components;
  if (tuples * components != given.float64_size())
  {
    vtkErrorMacro(<< this->GetXMLName() << " has " << given.float64_size() << " numbers, and takes "
                  << components << " for each. They are not used, what was set before stays.");
    return true; // said
  }
  vtkNew<vtkDoubleArray> values;
  values->SetNumberOfComponents(components);
  values->SetNumberOfTuples(tuples);
  for (int i = 0; i < tuples * components; ++i)
  {
    values->SetValue(i, given.float64(i));
  }
  vtkClientServerStream stream;
  stream << vtkClientServerStream::Invoke << this->GetVTKObject() << this->Command
         << static_cast<vtkObjectBase*>(values.GetPointer()) << vtkClientServerStream::End;
  return this->ProcessMessage(stream);
}
