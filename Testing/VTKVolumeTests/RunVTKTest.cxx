// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The main program of one of VTK's tests: FFD_VTK_TEST is the name of its function.
int FFD_VTK_TEST(int argc, char* argv[]);

int main(int argc, char* argv[])
{
  return FFD_VTK_TEST(argc, argv);
}
