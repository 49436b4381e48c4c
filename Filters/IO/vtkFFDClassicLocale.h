// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to this module: not installed.
#ifndef vtkFFDClassicLocale_h
#define vtkFFDClassicLocale_h

#include <clocale>
#include <cstddef>
#include <locale>
#include <mutex>
#include <string>

/**
 * Takes the classic locale for C++ streams as long as it lives, where the program has set another
 * one by std::locale::global(): VTK's readers and writers of MetaImage, DICOM and XML make streams
 * that follow it, so that they take "1.5" for 1, or for 15, and write 1024 as "1.024". The locale
 * is one of the whole process: the last of those that live at the same time, as where threads read,
 * sets that of the program again.
 */
class vtkFFDClassicLocale
{
public:
  vtkFFDClassicLocale()
  {
    Shared& shared = Get();
    const std::lock_guard<std::mutex> lock(shared.Mutex);
    if (shared.Alive++ == 0)
    {
      shared.Previous = std::locale();
      if (shared.Previous != std::locale::classic())
      {
        // With a C++ locale that has a name goes that of C, which may have been set apart.
        const char* const name = std::setlocale(LC_ALL, nullptr);
        shared.Name = name ? name : "";
        std::locale::global(std::locale::classic());
      }
    }
  }
  ~vtkFFDClassicLocale()
  {
    Shared& shared = Get();
    const std::lock_guard<std::mutex> lock(shared.Mutex);
    if (--shared.Alive == 0 && shared.Previous != std::locale::classic())
    {
      std::locale::global(shared.Previous);
      std::setlocale(LC_ALL, shared.Name.c_str());
    }
  }
  vtkFFDClassicLocale(const vtkFFDClassicLocale&) = delete;
  void operator=(const vtkFFDClassicLocale&) = delete;

private:
  struct Shared
  {
    std::mutex Mutex;
    std::size_t Alive = 0;
    std::locale Previous; ///< of the program, before the first of them
    std::string Name;
  };
  static Shared& Get()
  {
    static Shared shared;
    return shared;
  }
};

#endif
