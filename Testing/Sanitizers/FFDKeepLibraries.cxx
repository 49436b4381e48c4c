// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Linked into the tests of a sanitizer build: shared libraries stay loaded until the program ends.
// Mesa's driver is unloaded with the last window, and what it leaked can then be told from our
// leaks by no suppression, since the addresses belong to "<unknown module>".
extern "C" __attribute__((visibility("default"))) int dlclose(void*) { return 0; }
