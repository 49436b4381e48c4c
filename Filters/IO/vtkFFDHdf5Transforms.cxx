// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDHdf5Transforms.h"

#include "vtkFFDFileAccess.h"

#include "FFDBinaryNumbers.h"
#include "FFDFieldHeader.h"
#include "FFDItkTransform.h"
#include "FFDTextNumbers.h"

#include "vtk_hdf5.h"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace
{

/// Most numbers of one list: those of the largest field.
constexpr hsize_t LargestCount = 3 * static_cast<hsize_t>(ffd::LargestField);
/// Deflate packs no better than 1032 to 1; a small list may fit its header.
constexpr double LargestDeflation = 1032.0;
constexpr double SmallList = 65536.0;
constexpr std::size_t LongestText = 256;
constexpr int MincDimensions = 4;

/// An identifier of HDF5 that closes itself.
class Handle
{
public:
  using Closer = herr_t (*)(hid_t);
  Handle(hid_t id, Closer closer)
    : Id(id)
    , Close(closer)
  {
  }
  ~Handle()
  {
    if (this->Id >= 0)
    {
      this->Close(this->Id);
    }
  }
  Handle(const Handle&) = delete;
  void operator=(const Handle&) = delete;
  operator hid_t() const { return this->Id; }
  bool IsOpen() const { return this->Id >= 0; }

private:
  hid_t Id;
  Closer Close;
};

/// HDF5 prints no errors while this lives.
class Silence
{
public:
  Silence()
  {
    H5Eget_auto2(H5E_DEFAULT, &this->Function, &this->Data);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Silence() { H5Eset_auto2(H5E_DEFAULT, this->Function, this->Data); }
  Silence(const Silence&) = delete;
  void operator=(const Silence&) = delete;

private:
  H5E_auto2_t Function = nullptr;
  void* Data = nullptr;
};

/// Whether `parent` has an object of that name in this file: no soft or external link.
bool Has(hid_t parent, const char* name)
{
  H5L_info_t info;
  return H5Lexists(parent, name, H5P_DEFAULT) > 0 &&
    H5Lget_info(parent, name, &info, H5P_DEFAULT) >= 0 && info.type == H5L_TYPE_HARD;
}

hid_t OpenGroup(hid_t parent, const std::string& name)
{
  return Has(parent, name.c_str()) ? H5Gopen2(parent, name.c_str(), H5P_DEFAULT) : -1;
}

hid_t OpenDataSet(hid_t parent, const char* name)
{
  return Has(parent, name) ? H5Dopen2(parent, name, H5P_DEFAULT) : -1;
}

/// Whether the data lie in the file, packed by nothing but deflate, and are as many as it can hold.
bool IsContained(hid_t set, hsize_t count, std::size_t size)
{
  const Handle list(H5Dget_create_plist(set), H5Pclose);
  const H5D_layout_t layout = H5Pget_layout(list);
  if (!list.IsOpen() || H5Pget_external_count(list) != 0 ||
    (layout != H5D_CONTIGUOUS && layout != H5D_CHUNKED && layout != H5D_COMPACT))
  {
    return false;
  }
  const int filters = H5Pget_nfilters(list);
  for (int i = 0; i < filters; ++i)
  {
    unsigned int flags = 0;
    unsigned int config = 0;
    std::size_t values = 0;
    const H5Z_filter_t filter = H5Pget_filter2(
      list, static_cast<unsigned int>(i), &flags, &values, nullptr, 0, nullptr, &config);
    if (filter != H5Z_FILTER_DEFLATE && filter != H5Z_FILTER_SHUFFLE &&
      filter != H5Z_FILTER_FLETCHER32)
    {
      return false;
    }
  }
  if (layout == H5D_CHUNKED)
  {
    // A chunk is unpacked whole.
    hsize_t chunk[H5S_MAX_RANK];
    const int rank = H5Pget_chunk(list, H5S_MAX_RANK, chunk);
    double numbers = 1.0;
    for (int i = 0; i < rank; ++i)
    {
      numbers *= static_cast<double>(chunk[i]);
    }
    if (rank < 1 || numbers > std::max(static_cast<double>(count), SmallList))
    {
      return false;
    }
  }
  const double stored = static_cast<double>(H5Dget_storage_size(set));
  const double claimed = static_cast<double>(count) * static_cast<double>(size);
  return claimed <= stored * (filters > 0 ? LargestDeflation : 1.0) + SmallList;
}

/// All numbers of a set of floating-point numbers (or of integers, where `integers`).
bool ReadNumbers(hid_t set, bool integers, std::vector<hsize_t>& size, std::vector<double>& numbers)
{
  const Handle space(set >= 0 ? H5Dget_space(set) : -1, H5Sclose);
  const Handle type(set >= 0 ? H5Dget_type(set) : -1, H5Tclose);
  if (!space.IsOpen() || !type.IsOpen())
  {
    return false;
  }
  const H5T_class_t kind = H5Tget_class(type);
  const int rank = H5Sget_simple_extent_ndims(space);
  if (!(kind == H5T_FLOAT || (integers && kind == H5T_INTEGER)) || rank < 0 ||
    rank > MincDimensions)
  {
    return false;
  }
  size.assign(static_cast<std::size_t>(rank), 0);
  if (rank > 0 && H5Sget_simple_extent_dims(space, size.data(), nullptr) != rank)
  {
    return false;
  }
  hsize_t count = 1;
  for (const hsize_t n : size)
  {
    if (n > LargestCount || (count *= n) > LargestCount)
    {
      return false;
    }
  }
  if (!IsContained(set, count, H5Tget_size(type)))
  {
    return false;
  }
  numbers.resize(static_cast<std::size_t>(count));
  return count == 0 ||
    H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()) >= 0;
}

/// One text of fixed length, as a set or as an attribute.
template <class Reader>
bool ReadFixedText(hid_t typeId, hid_t spaceId, const Reader& read, std::string& text)
{
  const Handle type(typeId, H5Tclose);
  const Handle space(spaceId, H5Sclose);
  const Handle memory(H5Tcopy(H5T_C_S1), H5Tclose);
  text.assign(LongestText, '\0');
  if (!type.IsOpen() || !space.IsOpen() || H5Tget_class(type) != H5T_STRING ||
    H5Tis_variable_str(type) != 0 || H5Tget_size(type) > LongestText ||
    H5Sget_simple_extent_npoints(space) != 1 || H5Tset_size(memory, LongestText) < 0 ||
    read(memory, &text[0]) < 0)
  {
    return false;
  }
  text.resize(std::min(text.find('\0'), text.size()));
  return true;
}

/**
 * One text of variable length, which lies in a heap of the file, without HDF5's own function: that
 * of HDF5 1.10 trusts the sizes in a damaged heap and reads beyond it. A set holds the length, the
 * heap's address and the text's index in the heap; a heap holds objects of an index and a size.
 */
bool ReadHeapText(const std::string& name, hid_t set, std::string& text)
{
  constexpr std::size_t referenceSize = 16;
  constexpr std::size_t headSize = 16; // of a heap, and of an object in it
  constexpr std::uint64_t largestHeap = 1048576;
  const vtkFFDFileAccess::Proceed always = [] { return true; };
  std::string reference;
  std::string heap;
  std::string error;
  const haddr_t offset = H5Dget_offset(set);
  if (offset == HADDR_UNDEF || H5Dget_storage_size(set) != referenceSize ||
    !vtkFFDFileAccess::ReadBytes(
      name, static_cast<std::size_t>(offset), referenceSize, reference, always, error) ||
    reference.size() != referenceSize)
  {
    return false;
  }
  const auto word = [](const std::string& bytes, std::size_t at, std::size_t size) {
    return ffd::LoadBits(ffd::BytesAt(bytes, at), size, false);
  };
  const std::uint64_t length = word(reference, 0, 4);
  const std::uint64_t index = word(reference, 12, 4);
  const std::size_t address = static_cast<std::size_t>(word(reference, 4, 8));
  if (length > LongestText ||
    !vtkFFDFileAccess::ReadBytes(name, address, largestHeap, heap, always, error) ||
    heap.size() < headSize || heap.compare(0, 4, "GCOL") != 0)
  {
    return false;
  }
  const std::size_t end =
    static_cast<std::size_t>(std::min<std::uint64_t>(word(heap, 8, 8), heap.size()));
  for (std::size_t at = headSize; at + headSize <= end;)
  {
    const std::uint64_t size = word(heap, at + 8, 8);
    if (word(heap, at, 2) == 0 || size > end - at - headSize)
    {
      return false; // the free space at the end
    }
    if (word(heap, at, 2) == index)
    {
      text =
        heap.substr(at + headSize, static_cast<std::size_t>(std::min<std::uint64_t>(size, length)));
      text.resize(std::min(text.find('\0'), text.size()));
      return true;
    }
    at += headSize + static_cast<std::size_t>((size + 7) / 8 * 8);
  }
  return false;
}

bool ReadTextSet(const std::string& name, hid_t parent, const char* setName, std::string& text)
{
  const Handle set(OpenDataSet(parent, setName), H5Dclose);
  if (!set.IsOpen() || !IsContained(set, 1, 1))
  {
    return false;
  }
  const Handle type(H5Dget_type(set), H5Tclose);
  if (type.IsOpen() && H5Tis_variable_str(type) > 0)
  {
    return ReadHeapText(name, set, text);
  }
  return ReadFixedText(
    H5Dget_type(set), H5Dget_space(set),
    [&set](hid_t memory, void* data) {
      return H5Dread(set, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, data);
    },
    text);
}

bool ReadTextAttribute(hid_t object, const char* name, std::string& text)
{
  const Handle attribute(
    H5Aexists(object, name) > 0 ? H5Aopen(object, name, H5P_DEFAULT) : -1, H5Aclose);
  return attribute.IsOpen() &&
    ReadFixedText(
      H5Aget_type(attribute), H5Aget_space(attribute),
      [&attribute](hid_t memory, void* data) { return H5Aread(attribute, memory, data); }, text);
}

/// `count` numbers of an attribute.
bool ReadAttribute(hid_t object, const char* name, int count, double* numbers)
{
  const Handle attribute(
    H5Aexists(object, name) > 0 ? H5Aopen(object, name, H5P_DEFAULT) : -1, H5Aclose);
  const Handle space(attribute.IsOpen() ? H5Aget_space(attribute) : -1, H5Sclose);
  const Handle type(attribute.IsOpen() ? H5Aget_type(attribute) : -1, H5Tclose);
  return space.IsOpen() && type.IsOpen() && H5Sget_simple_extent_npoints(space) == count &&
    (H5Tget_class(type) == H5T_FLOAT || H5Tget_class(type) == H5T_INTEGER) &&
    H5Aread(attribute, H5T_NATIVE_DOUBLE, numbers) >= 0;
}

/// One list of parameters, which earlier ITK misspells "Tranform".
bool ReadParameters(hid_t group, const std::string& name, std::vector<double>& numbers)
{
  const std::string misspelled = "Tran" + name.substr(5);
  const Handle set(
    OpenDataSet(group, Has(group, name.c_str()) ? name.c_str() : misspelled.c_str()), H5Dclose);
  std::vector<hsize_t> size;
  return set.IsOpen() && ReadNumbers(set, false, size, numbers) && size.size() == 1;
}

bool Open(const std::string& name, hid_t& file, std::string& error)
{
  std::size_t size = 0;
  if (!vtkFFDFileAccess::FindSize(name, size, error))
  {
    return false;
  }
  file = H5Fopen(name.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  error = file >= 0 ? "" : "it is no HDF5 file, or a damaged one";
  return file >= 0;
}

/// The order of the dimensions of a MINC image, and where each is spatial axis 0 to 2 or 3, the
/// vectors' components.
bool ReadMincOrder(hid_t image, int order[MincDimensions])
{
  static const char* const names[MincDimensions] = { "xspace", "yspace", "zspace",
    "vector_dimension" };
  std::string text;
  if (!ReadTextAttribute(image, "dimorder", text))
  {
    return false;
  }
  int used = 0;
  std::string_view rest = text;
  for (int i = 0; i < MincDimensions; ++i)
  {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    const auto found = std::find(names, names + MincDimensions, ffd::Trim(rest.substr(0, comma)));
    rest.remove_prefix(std::min(comma + 1, rest.size()));
    if (found == names + MincDimensions)
    {
      return false;
    }
    order[i] = static_cast<int>(found - names);
    used |= 1 << order[i];
  }
  return used == 15 && rest.empty();
}

/// Position, spacing and direction of the nodes; a negative step turns the axis.
bool ReadMincAxes(hid_t root, ffd::TransformGrid& grid)
{
  const Handle dimensions(OpenGroup(root, "dimensions"), H5Gclose);
  static const char* const names[] = { "xspace", "yspace", "zspace" };
  grid.Origin = glm::dvec3(0.0);
  for (int a = 0; a < 3 && dimensions.IsOpen(); ++a)
  {
    const Handle axis(OpenDataSet(dimensions, names[a]), H5Dclose);
    double start = 0.0;
    double step = 1.0;
    glm::dvec3 direction(0.0);
    direction[a] = 1.0;
    if (!axis.IsOpen() || !ReadAttribute(axis, "step", 1, &step))
    {
      return false;
    }
    ReadAttribute(axis, "start", 1, &start);
    ReadAttribute(axis, "direction_cosines", 3, &direction.x);
    grid.Spacing[a] = std::abs(step);
    grid.Direction[a] = step < 0.0 ? -direction : direction;
    grid.Origin += start * direction;
  }
  return dimensions.IsOpen();
}

/**
 * Integers are scaled from their valid range to image-min ... image-max, which are two numbers, or
 * such of each slice (each index of the first, or of the first two dimensions). MINC keeps
 * floating-point numbers as they are.
 */
bool ScaleMincValues(
  hid_t group, hid_t image, const std::vector<hsize_t>& size, std::vector<double>& values)
{
  const Handle type(H5Dget_type(image), H5Tclose);
  if (H5Tget_class(type) == H5T_FLOAT)
  {
    return true;
  }
  double valid[2] = { 0.0, 0.0 };
  const double bits = 8.0 * static_cast<double>(H5Tget_size(type));
  const bool isSigned = H5Tget_sign(type) != H5T_SGN_NONE;
  if (!ReadAttribute(image, "valid_range", 2, valid) || !(valid[0] < valid[1]))
  {
    valid[0] = isSigned ? -std::ldexp(1.0, static_cast<int>(bits) - 1) : 0.0;
    valid[1] = std::ldexp(1.0, static_cast<int>(bits) - (isSigned ? 1 : 0)) - 1.0;
  }
  std::vector<double> range[2];
  std::vector<hsize_t> slices[2];
  static const char* const names[] = { "image-min", "image-max" };
  for (int i = 0; i < 2; ++i)
  {
    const Handle set(OpenDataSet(group, names[i]), H5Dclose);
    if (!ReadNumbers(set, false, slices[i], range[i]) || range[i].empty() ||
      slices[i].size() >= size.size() ||
      !std::equal(slices[i].begin(), slices[i].end(), size.begin()))
    {
      return false;
    }
  }
  if (range[0].size() != range[1].size())
  {
    return false;
  }
  const std::size_t slice = values.size() / range[0].size();
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    const double low = range[0][i / slice];
    const double high = range[1][i / slice];
    values[i] = low + (values[i] - valid[0]) / (valid[1] - valid[0]) * (high - low);
  }
  return true;
}

} // namespace

namespace vtkFFDHdf5Transforms
{

//------------------------------------------------------------------------------
bool LooksLikeHdf5(std::string_view bytes) { return bytes.substr(0, 8) == "\x89HDF\r\n\x1a\n"; }

//------------------------------------------------------------------------------
bool ReadItk(const std::string& name, std::vector<ffd::TransformStep>& steps, std::string& error)
{
  const Silence silence;
  hid_t id = -1;
  if (!Open(name, id, error))
  {
    return false;
  }
  const Handle file(id, H5Fclose);
  const Handle transforms(OpenGroup(file, "TransformGroup"), H5Gclose);
  if (!transforms.IsOpen())
  {
    error = "there is no TransformGroup in it, as ITK writes";
    return false;
  }
  std::vector<std::string> types;
  while (types.size() <= ffd::LargestChain + 1)
  {
    const Handle group(OpenGroup(transforms, std::to_string(types.size())), H5Gclose);
    if (!group.IsOpen())
    {
      break;
    }
    types.emplace_back();
    if (!ReadTextSet(name, group, "TransformType", types.back()))
    {
      error = "a transform has no TransformType";
      return false;
    }
  }
  std::size_t skipped = 0;
  if (!ffd::CheckItkList(types.size(), types.empty() ? std::string() : types[0], skipped, error))
  {
    return false;
  }
  for (std::size_t i = skipped; i < types.size(); ++i)
  {
    const Handle group(OpenGroup(transforms, std::to_string(i)), H5Gclose);
    std::vector<double> parameters;
    std::vector<double> fixed;
    if (!ReadParameters(group, "TransformParameters", parameters) ||
      !ReadParameters(group, "TransformFixedParameters", fixed))
    {
      error = "the parameters of the " + ffd::Quote(types[i]) +
        " are no list of numbers in the file itself, unpacked or packed by deflate";
      return false;
    }
    ffd::TransformStep step;
    if (!ffd::MakeItkStep(types[i], parameters, fixed, step, error))
    {
      return false;
    }
    steps.push_back(std::move(step));
  }
  // The one that was added last to a CompositeTransform is applied first.
  std::reverse(steps.begin(), steps.end());
  return true;
}

//------------------------------------------------------------------------------
bool ReadMincGrid(const std::string& name, ffd::TransformStep& step, std::string& error)
{
  const Silence silence;
  hid_t id = -1;
  if (!Open(name, id, error))
  {
    return false;
  }
  const Handle file(id, H5Fclose);
  const Handle root(OpenGroup(file, "minc-2.0"), H5Gclose);
  const Handle images(root.IsOpen() ? OpenGroup(root, "image") : -1, H5Gclose);
  const Handle group(images.IsOpen() ? OpenGroup(images, "0") : -1, H5Gclose);
  const Handle image(group.IsOpen() ? OpenDataSet(group, "image") : -1, H5Dclose);
  int order[MincDimensions];
  std::vector<hsize_t> size;
  std::vector<double> values;
  if (!image.IsOpen() || !ReadMincOrder(image, order) || !ReadMincAxes(root, step.Grid))
  {
    error = "it is no MINC 2 volume of xspace, yspace, zspace and vector_dimension";
    return false;
  }
  if (!ReadNumbers(image, true, size, values) || size.size() != MincDimensions ||
    !ScaleMincValues(group, image, size, values))
  {
    error = "its image is no array of numbers in the file itself, unpacked or packed by deflate";
    return false;
  }
  // Distance of neighbors along each of x, y, z and the components.
  std::size_t stride[MincDimensions];
  std::size_t total = 1;
  for (int i = MincDimensions - 1; i >= 0; --i)
  {
    const hsize_t n = size[static_cast<std::size_t>(i)];
    stride[order[i]] = total;
    total *= static_cast<std::size_t>(n);
    if (order[i] < 3)
    {
      step.Grid.Size[order[i]] =
        static_cast<int>(std::min<hsize_t>(n, std::numeric_limits<int>::max()));
    }
    else if (n != 3)
    {
      error = "its vector_dimension is not 3";
      return false;
    }
  }
  error = ffd::FindGridProblem(step.Grid, 1);
  if (!error.empty())
  {
    return false;
  }
  step.Type = ffd::TransformStep::Kind::Field;
  step.Values.clear();
  step.Values.reserve(total / 3);
  const auto along = [&stride](
                       int axis, int i) { return stride[axis] * static_cast<std::size_t>(i); };
  glm::ivec3 i;
  for (i.z = 0; i.z < step.Grid.Size.z; ++i.z)
  {
    for (i.y = 0; i.y < step.Grid.Size.y; ++i.y)
    {
      for (i.x = 0; i.x < step.Grid.Size.x; ++i.x)
      {
        const std::size_t first = along(0, i.x) + along(1, i.y) + along(2, i.z);
        glm::dvec3 value;
        for (int c = 0; c < 3; ++c)
        {
          value[c] = values[first + along(3, c)];
          if (!(std::abs(value[c]) <= ffd::LargestNumber))
          {
            error = "a displacement is not a finite number of at most 1e12";
            return false;
          }
        }
        step.Values.push_back(value);
      }
    }
  }
  return true;
}

} // namespace vtkFFDHdf5Transforms
