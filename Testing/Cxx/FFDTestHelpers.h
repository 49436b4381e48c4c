// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDTestHelpers_h
#define FFDTestHelpers_h

#include "vtkCommand.h"
#include "vtkFFDLattice.h"
#include "vtkMinimalStandardRandomSequence.h"
#include "vtkNew.h"
#include "vtkObject.h"

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <string>

/// Fail the test with the place and what was expected.
#define FFD_CHECK(condition)                                                                       \
  do                                                                                               \
  {                                                                                                \
    if (!(condition))                                                                              \
    {                                                                                              \
      std::cerr << __FILE__ << ":" << __LINE__ << ": not true: " #condition "\n";                  \
      return EXIT_FAILURE;                                                                         \
    }                                                                                              \
  } while (false)

/// |a - b| <= tolerance, printed with the numbers.
#define FFD_CHECK_NEAR(a, b, tolerance)                                                            \
  do                                                                                               \
  {                                                                                                \
    const double ffdA = (a);                                                                       \
    const double ffdB = (b);                                                                       \
    if (!(std::abs(ffdA - ffdB) <= (tolerance)))                                                   \
    {                                                                                              \
      std::cerr << __FILE__ << ":" << __LINE__ << ": " #a " = " << ffdA << ", " #b " = " << ffdB   \
                << "\n";                                                                           \
      return EXIT_FAILURE;                                                                         \
    }                                                                                              \
  } while (false)

/// Collects the error messages of an object instead of printing them.
class FFDErrorLog : public vtkCommand
{
public:
  static FFDErrorLog* New() { return new FFDErrorLog; }
  void Execute(vtkObject*, unsigned long event, void* data) override
  {
    if (event == vtkCommand::ErrorEvent && data)
    {
      this->Message += static_cast<const char*>(data);
      ++this->Count;
    }
  }
  void Watch(vtkObject* object) { object->AddObserver(vtkCommand::ErrorEvent, this); }
  /// Exactly one error since the last call, with this text in it.
  bool Had(const std::string& text)
  {
    const bool ok = this->Count == 1 && this->Message.find(text) != std::string::npos;
    if (!ok)
    {
      std::cerr << this->Count << " errors, expected one with \"" << text << "\": " << this->Message
                << "\n";
    }
    this->Count = 0;
    this->Message.clear();
    return ok;
  }
  int Count = 0;
  std::string Message;
};

/// Reproducible numbers in [lo, hi).
class FFDRandom
{
public:
  explicit FFDRandom(int seed) { this->Sequence->Initialize(static_cast<vtkTypeUInt32>(seed)); }
  double Number(double lo, double hi)
  {
    const double value = this->Sequence->GetRangeValue(lo, hi);
    this->Sequence->Next();
    return value;
  }
  /// A point in the lattice's domain or up to `margin` spacings outside.
  void Point(vtkFFDLattice* lattice, double margin, double p[3])
  {
    double domain[6];
    double spacing[3];
    lattice->GetDomain(domain);
    lattice->GetSpacing(spacing);
    for (int a = 0; a < 3; ++a)
    {
      p[a] =
        this->Number(domain[2 * a] - margin * spacing[a], domain[2 * a + 1] + margin * spacing[a]);
    }
  }
  /// Random displacements of up to `amount` spacings per axis.
  void Shape(vtkFFDLattice* lattice, double amount)
  {
    int n[3];
    double spacing[3];
    lattice->GetDimensions(n);
    lattice->GetSpacing(spacing);
    for (int k = 0; k < n[2]; ++k)
    {
      for (int j = 0; j < n[1]; ++j)
      {
        for (int i = 0; i < n[0]; ++i)
        {
          const double x = amount * spacing[0] * this->Number(-1.0, 1.0);
          const double y = amount * spacing[1] * this->Number(-1.0, 1.0);
          const double z = amount * spacing[2] * this->Number(-1.0, 1.0);
          lattice->SetDisplacement(i, j, k, x, y, z);
        }
      }
    }
  }

private:
  vtkNew<vtkMinimalStandardRandomSequence> Sequence;
};

inline double FFDDistance(const double a[3], const double b[3])
{
  return std::sqrt(
    (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

#endif
