// SPDX-License-Identifier: MIT
#pragma once
// Arrays of numbers in a container, whatever the container: where their columns are, and how a log is made of
// them.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "log/containers/stored_bytes.hpp"
#include "log/npy/npy_field.hpp"
#include "log/records/open_records.hpp"

namespace ripplenotch {

/// The numbers of one column, from its first row on.
class ColumnCursor {
  public:
    virtual ~ColumnCursor() = default;
    /// The bytes of the next `rows` numbers, one behind the other. Throws DataError where they are not there.
    virtual void read(std::size_t rows, char* into) = 0;
};

/// An array of one dimension or two as columns over time. The longer side is time.
struct ArrayShape {
    std::size_t rows = 0, columns = 1;
    bool vector = true;         ///< a column without a number
    bool time_is_first = true;  ///< of the two dimensions
};
/// None where an array is no log: no rows, more than 64 columns, or more than two dimensions longer than 1.
[[nodiscard]] std::optional<ArrayShape> shape_over_time(const std::vector<std::uint64_t>& dimensions);

struct StoredArray {
    std::string path;  ///< as the container has it: "log.q_dot", "/log/q_dot"
    ArrayShape shape;
    NpyField type;  ///< of a number; its offset means nothing
    std::string unit;
    std::function<std::unique_ptr<ColumnCursor>(std::size_t column)> open;
    std::string read_as;  ///< in place of the path, where that says less than the container does
};

/// Numbers at equal distances in stored bytes.
[[nodiscard]] std::unique_ptr<ColumnCursor> strided_cursor(std::shared_ptr<StoredBytes> bytes,
                                                           std::uint64_t start, std::uint64_t stride,
                                                           std::size_t size);

/// How a column of a matrix is written.
enum class PathStyle {
    matlab,  ///< log.q(:,3), counted from 1
    numpy    ///< /log/q[:,2], counted from 0
};

/// The records of a log made of arrays of one clock or one length: of those that --columns names, else of
/// those whose names say most. What --columns names of arrays with other clocks is joined by time. `extra`
/// goes to the list of contents only. Throws DataError where there is nothing to take, UsageError where
/// --columns names what does not fit together.
[[nodiscard]] Records records_of_arrays(const std::shared_ptr<StoredBytes>& file, const std::string& format,
                                        PathStyle style, const std::vector<StoredArray>& arrays,
                                        const std::vector<ContentEntry>& extra, const ReadOptions& options);

/// How many of time, velocity, torque and position the names speak of, torque counting thrice; by which the
/// part of a container is chosen that is read.
[[nodiscard]] int names_tell(const std::vector<std::string>& names);

/// "f8" as people say it: "float64".
[[nodiscard]] std::string type_name(const NpyField& type);

}  // namespace ripplenotch
