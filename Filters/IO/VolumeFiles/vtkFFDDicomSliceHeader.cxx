// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDDicomSliceHeader.h"

#include "FFDBinaryNumbers.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <locale>
#include <sstream>
#include <string>

namespace
{

constexpr std::uint32_t Undefined = 0xffffffff;
constexpr std::uint32_t ItemEnd = 0xfffee00d;
constexpr std::uint32_t SequenceEnd = 0xfffee0dd;
constexpr std::uint32_t PixelData = 0x7fe00010;
constexpr int DeepestSequence = 16;

struct Element
{
  std::uint32_t Tag = 0;
  std::uint32_t Length = 0;
  std::string_view Type; ///< empty where types are implicit
};

/// Whether this is a type of values. Elements without one are among others in files of some
/// scanners.
bool IsType(std::string_view type)
{
  return std::all_of(type.begin(), type.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
}

/// Takes elements off the front of the bytes.
class ElementStream
{
public:
  ElementStream(std::string_view bytes, std::size_t at)
    : Bytes(bytes)
    , At(at)
  {
  }

  bool IsExplicit = true;
  bool IsBigEndian = false;

  std::size_t GetPlace() const { return this->At; }
  std::uint32_t Number(std::size_t at, std::size_t size) const
  {
    return static_cast<std::uint32_t>(
      ffd::LoadBits(ffd::BytesAt(this->Bytes, at), size, this->IsBigEndian));
  }

  /// The head of the next element; false at the end of the bytes.
  bool Next(Element& element)
  {
    if (!this->Has(8))
    {
      return false;
    }
    element.Tag = this->Number(this->At, 2) << 16 | this->Number(this->At + 2, 2);
    element.Type = std::string_view();
    const bool isItem = element.Tag >> 16 == 0xfffe;
    if (!this->IsExplicit || isItem || !IsType(this->Bytes.substr(this->At + 4, 2)))
    {
      element.Length = this->Number(this->At + 4, 4);
      this->At += 8;
      return true;
    }
    element.Type = this->Bytes.substr(this->At + 4, 2);
    bool isLong = false;
    for (const char* type :
      { "OB", "OD", "OF", "OL", "OV", "OW", "SQ", "SV", "UC", "UN", "UR", "UT", "UV" })
    {
      isLong = isLong || element.Type == type;
    }
    if (isLong && !this->Has(12))
    {
      return false;
    }
    element.Length = isLong ? this->Number(this->At + 8, 4) : this->Number(this->At + 6, 2);
    this->At += isLong ? 12 : 8;
    return true;
  }

  /// Leaves out the value of an element, whose end may have a mark of its own.
  bool Skip(const Element& element, int depth = 0)
  {
    if (element.Length != Undefined)
    {
      this->At += element.Length;
      return this->Has(0);
    }
    Element inner;
    while (depth < DeepestSequence && this->Next(inner))
    {
      if (inner.Tag == SequenceEnd || inner.Tag == ItemEnd)
      {
        return true;
      }
      if (!this->Skip(inner, depth + 1))
      {
        return false;
      }
    }
    return false;
  }

  std::string_view Value(const Element& element) const
  {
    return this->Has(element.Length) ? this->Bytes.substr(this->At, element.Length)
                                     : std::string_view();
  }

private:
  bool Has(std::size_t count) const
  {
    return this->At <= this->Bytes.size() && count <= this->Bytes.size() - this->At;
  }

  std::string_view Bytes;
  std::size_t At;
};

/// "x\y\z".
bool ReadPosition(std::string_view text, double position[3])
{
  std::istringstream stream{ std::string(text) };
  stream.imbue(std::locale::classic());
  char between = '\\';
  for (int a = 0; a < 3; ++a)
  {
    if (between != '\\' || !(stream >> position[a]))
    {
      return false;
    }
    stream >> between;
  }
  return true;
}

/// Whether VTK's reader takes a number, as text, for none that is whole.
bool IsNoWholeNumber(std::string_view text)
{
  std::istringstream stream{ std::string(text) };
  stream.imbue(std::locale::classic());
  double number = 0.0;
  constexpr double largest = std::numeric_limits<int>::max();
  return (stream >> number) && (std::trunc(number) != number || std::abs(number) > largest);
}

/// The name of an element that must have a value, or null.
const char* FindNameOfNeeded(std::uint32_t tag)
{
  switch (tag)
  {
    case 0x00020010:
      return "Transfer Syntax UID (0002,0010)";
    case 0x00180050:
      return "Slice Thickness (0018,0050)";
    case 0x0020000e:
      return "Series Instance UID (0020,000e)";
    case 0x00280004:
      return "Photometric Interpretation (0028,0004)";
    case 0x00280010:
      return "Rows (0028,0010)";
    case 0x00280011:
      return "Columns (0028,0011)";
    case 0x00280100:
      return "Bits Allocated (0028,0100)";
    case 0x00280103:
      return "Pixel Representation (0028,0103)";
    case 0x00281052:
      return "Rescale Intercept (0028,1052)";
    case 0x00281053:
      return "Rescale Slope (0028,1053)";
    default:
      return nullptr;
  }
}

/// Bytes of the pixels; those of the element may be one more, or fewer.
std::size_t CountBytes(const vtkFFDDicomSliceHeader& header)
{
  std::size_t bits = static_cast<std::size_t>(header.Samples > 0 ? header.Samples : 1);
  for (const int number : { header.Rows, header.Columns, header.Bits })
  {
    bits *= static_cast<std::size_t>(number);
  }
  return bits / 8;
}

} // namespace

//------------------------------------------------------------------------------
vtkFFDDicomSliceHeader vtkFFDDicomSliceHeader::Parse(std::string_view bytes)
{
  vtkFFDDicomSliceHeader header;
  constexpr std::size_t start = 132; // behind the preamble and "DICM"
  ElementStream stream(bytes, start);
  std::string syntax;
  bool isInFile = false; // behind what describes the file itself, which is always explicit
  Element element;
  for (;;)
  {
    const std::size_t place = stream.GetPlace();
    if (!stream.Next(element))
    {
      header.End = place < bytes.size() ? bytes.size() + 1 : 0; // at least
      header.Pixels =
        place == bytes.size() ? vtkFFDDicomSliceHeader::NONE : vtkFFDDicomSliceHeader::UNKNOWN;
      return header;
    }
    if (!isInFile && element.Tag >> 16 != 2)
    {
      isInFile = true;
      stream = ElementStream(bytes, place);
      stream.IsExplicit = syntax != "1.2.840.10008.1.2";
      stream.IsBigEndian = syntax == "1.2.840.10008.1.2.2";
      if (syntax == "1.2.840.10008.1.2.1.99")
      {
        return header; // what follows is deflated
      }
      continue;
    }
    const std::string_view value = stream.Value(element);
    if (element.Length == 0 && !header.Empty)
    {
      header.Empty = FindNameOfNeeded(element.Tag);
    }
    const int number =
      value.size() == 2 ? static_cast<int>(stream.Number(stream.GetPlace(), 2)) : 0;
    switch (element.Tag)
    {
      case 0x00020010:
        syntax = std::string(value.substr(0, value.find_first_of(std::string_view("\0 ", 2))));
        break;
      case 0x00200032:
        header.HasPosition = ReadPosition(value, header.Position);
        break;
      case 0x00280002:
        header.Samples = number;
        break;
      case 0x00280010:
        header.Rows = number;
        break;
      case 0x00280011:
        header.Columns = number;
        break;
      case 0x00280100:
        header.Bits = number;
        break;
      case 0x00281052:
      case 0x00281053:
        header.IsFraction = header.IsFraction || IsNoWholeNumber(value);
        break;
      case PixelData:
        header.Pixels = vtkFFDDicomSliceHeader::FOUND;
        header.End = element.Length == Undefined ? 0 : stream.GetPlace() + CountBytes(header);
        return header;
      default:
        break;
    }
    if (!stream.Skip(element))
    {
      // Sequences without a length may be encoded otherwise.
      header.End = element.Length == Undefined ? 0 : stream.GetPlace();
      return header;
    }
  }
}
