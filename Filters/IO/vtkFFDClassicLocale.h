// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to this module: not installed.
#ifndef vtkFFDClassicLocale_h
#define vtkFFDClassicLocale_h

#include <clocale>
#include <locale>
#include <string>

/**
 * Takes the classic locale for C++ streams as long as it lives, where the program has set another
 * one by std::locale::global(): VTK's readers and writers of MetaImage, DICOM and XML make streams
 * that follow it, so that they take "1.5" for 1, or for 15, and write 1024 as "1.024". The locale
 * is one of the whole process.
 */
class vtkFFDClassicLocale
{
public:
  vtkFFDClassicLocale()
  {
    if (this->Previous != std::locale::classic())
    {
      // With a C++ locale that has a name goes that of C, which may have been set apart.
      const char* const name = std::setlocale(LC_ALL, nullptr);
      this->Name = name ? name : "";
      std::locale::global(std::locale::classic());
    }
  }
  ~vtkFFDClassicLocale()
  {
    if (this->Previous != std::locale::classic())
    {
      std::locale::global(this->Previous);
      std::setlocale(LC_ALL, this->Name.c_str());
    }
  }
  vtkFFDClassicLocale(const vtkFFDClassicLocale&) = delete;
  void operator=(const vtkFFDClassicLocale&) = delete;

private:
  std::locale Previous;
  std::string Name;
};

#endif
