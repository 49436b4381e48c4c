// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDStage_h
#define FFDStage_h

#include "FFDParallelFor.h"

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>

namespace ffd
{

/// Outcome of a maker for the result of its stage.
enum class Made
{
  Anew, ///< the result is another one
  Same, ///< the inputs are others, but the result stays as it was
  Not   ///< there is no result; StageTools::Message tells the user why
};

/// Tools of a maker besides its inputs. The result must not depend on them.
struct StageTools
{
  ParallelFor Parallel;
  std::string Message; ///< why there is no result
  std::string Warning; ///< a reservation about the result
};

/// An object that a stage reads, and the modification time that tells its states apart.
template <class T>
struct Source
{
  T* Object = nullptr; ///< not owned; may be null
  std::uint64_t Time = 0;

  bool operator==(const Source& other) const
  {
    return this->Object == other.Object && this->Time == other.Time;
  }
};

/**
 * Orders the stages of one cache, and numbers its updates. Stages are declared after their order,
 * each after those whose results it takes.
 */
class StageOrder
{
public:
  StageOrder() = default;
  StageOrder(const StageOrder&) = delete;
  StageOrder& operator=(const StageOrder&) = delete;

  /// Begin an update: from here on a stage takes the results of those that were updated since.
  void Begin() { ++this->Pass; }

private:
  template <auto Maker, class>
  friend class Stage;

  int NumberOfStages = 0;
  std::uint64_t Pass = 1;
  std::uint64_t LastVersion = 0;
};

/**
 * The result of a stage, as the input of a later one. It is another input when the stage has made
 * its result anew. Stage::GetProduct() is the only source of products that are not empty.
 */
template <class Result>
class Product
{
public:
  const Result& operator*() const { return *this->Value; }
  const Result* operator->() const { return this->Value; }
  std::uint64_t GetVersion() const { return this->Version; }

  /// The same for a stage that depends on a part of the result only, which has a version of its
  /// own.
  Product WithVersion(std::uint64_t version) const
  {
    Product part = *this;
    part.Version = version;
    return part;
  }

  bool operator==(const Product& other) const
  {
    return this->Value == other.Value && this->Version == other.Version;
  }

private:
  template <auto Maker, class>
  friend class Stage;

  const Result* Value = nullptr;
  std::uint64_t Version = 0;
  const StageOrder* Order = nullptr;
  int Position = 0;
  std::uint64_t Pass = 0;
};

/**
 * Keeps the result of a function, `Maker`, and makes it again when an argument has changed:
 *
 * @code
 * Made MakeBlocks(Blocks& result, StageTools& tools, const Product<Voxels>& voxels, int size);
 *
 * StageOrder Order;
 * Stage<&MakeVoxels> Voxels{ Order };
 * Stage<&MakeBlocks> Blocks{ Order };
 * @endcode
 *
 * The parameters of the maker declare what the stage depends on. A maker is a plain function, so it
 * reads nothing else: every input is compared, none can be forgotten. Inputs are values, Sources
 * (objects with a time) and Products (results of earlier stages), all of them compared by ==.
 *
 * A result is valid from the end of its maker on. A maker that fails or throws, as by an abort,
 * leaves none: the next update makes it again, whatever the inputs are, and what depends on it too.
 * The result that was made last is handed to the maker, which may use its memory.
 */
template <auto Maker, class Signature = decltype(Maker)>
class Stage;

template <auto Maker, class Result, class... Parameters>
class Stage<Maker, Made (*)(Result&, StageTools&, Parameters...)>
{
public:
  explicit Stage(StageOrder& order)
    : Order(order)
    , Position(order.NumberOfStages++)
  {
  }
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  /// Bring the result up to date. False, with a message in `tools`, if there is none.
  bool Update(StageTools& tools, const std::decay_t<Parameters>&... inputs)
  {
    (this->Check(inputs), ...);
    this->Pass = this->Order.Pass;
    if (this->Inputs && *this->Inputs == std::tie(inputs...))
    {
      return true;
    }
    const bool wasMade = this->Inputs.has_value();
    this->Inputs.reset();
    const Made made = Maker(this->Last, tools, inputs...);
    if (made == Made::Not)
    {
      return false;
    }
    if (made == Made::Anew || !wasMade)
    {
      this->Version = ++this->Order.LastVersion;
      ++this->Builds;
    }
    this->Inputs.emplace(inputs...);
    return true;
  }

  /// Free the result.
  void Clear()
  {
    this->Inputs.reset();
    this->Last = Result();
  }

  bool HasResult() const { return this->Inputs.has_value(); }

  /// The result, which must be there.
  const Result& Get() const
  {
    if (!this->Inputs)
    {
      throw std::logic_error("A result is used that has not been made.");
    }
    return this->Last;
  }
  const Result* operator->() const { return &this->Get(); }

  /// The result as the input of a later stage.
  Product<Result> GetProduct() const
  {
    Product<Result> product;
    product.Value = &this->Get();
    product.Version = this->Version;
    product.Order = &this->Order;
    product.Position = this->Position;
    product.Pass = this->Pass;
    return product;
  }

  /// The last result, even if it is not valid: for the memory that it takes.
  const Result& GetLast() const { return this->Last; }

  /// Number of times that a new result was made.
  std::int64_t GetNumberOfBuilds() const { return this->Builds; }

private:
  template <class Input>
  void Check(const Input&) const
  {
  }
  template <class Other>
  void Check(const Product<Other>& input) const
  {
    if (input.Order != &this->Order || input.Position >= this->Position ||
      input.Pass != this->Order.Pass)
    {
      throw std::logic_error("A stage takes a result that is not of an earlier stage of its order, "
                             "or that was not brought up to date before.");
    }
  }

  StageOrder& Order;
  int Position;
  std::uint64_t Pass = 0;
  std::uint64_t Version = 0;
  std::int64_t Builds = 0;
  Result Last{};
  std::optional<std::tuple<std::decay_t<Parameters>...>> Inputs; // of a valid result
};

} // namespace ffd

#endif
