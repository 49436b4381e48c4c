// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Preloaded into ParaView 5.11 by Examples/paraview.sh and by the tests. Since 2.6.0, and in Debian
// 12 since 2.5.0-1+deb12u2, expat puts off what it cannot finish, and ParaView 5.11 then reads the
// binary part of an XML file as XML: "not well-formed (invalid token)" (VTK issue 19258; mended in
// Debian's VTK 9.1 and in ParaView 5.13). Such are the files that ParaView writes by default, and
// the surfaces that its processes exchange.
#include <dlfcn.h>

extern "C" void* XML_ParserCreate(const char* encoding)
{
  void* expat = dlopen("libexpat.so.1", RTLD_NOW);
  if (!expat)
  {
    return nullptr;
  }
  using Create = void* (*)(const char*);
  using SetDeferral = unsigned char (*)(void*, unsigned char);
  const auto create = reinterpret_cast<Create>(dlsym(expat, "XML_ParserCreate"));
  // Older versions do not have it, and need it not.
  const auto setDeferral =
    reinterpret_cast<SetDeferral>(dlsym(expat, "XML_SetReparseDeferralEnabled"));
  void* parser = create ? create(encoding) : nullptr;
  if (parser && setDeferral)
  {
    setDeferral(parser, 0);
  }
  return parser;
}
