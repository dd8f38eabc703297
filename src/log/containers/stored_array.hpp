// SPDX-License-Identifier: MIT
#pragma once
// Arrays of numbers in a container, whatever the container: where their columns are, and how a log is made of
// them.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/files/byte_sink.hpp"
#include "log/npy/npy_header.hpp"
#include "log/numbers/columns.hpp"
#include "log/unpack/unpacked_source.hpp"
#include "ripplenotch/core/files.hpp"

namespace ripplenotch {

// The bytes of a container, which is read here and there.

class StoredBytes {
  public:
    virtual ~StoredBytes() = default;
    /// 0 where nobody knows before all have been unpacked.
    [[nodiscard]] virtual std::uint64_t size() const = 0;
    /// Throws DataError, beginning with the source's name, where there are not as many.
    virtual void read_at(std::uint64_t offset, char* into, std::size_t size) = 0;
    [[nodiscard]] std::string text_at(std::uint64_t offset, std::size_t size) {
        std::string text(size, '\0');
        read_at(offset, text.data(), size);
        return text;
    }
    /// Calls `open` with a name under which libraries can open a file that holds them, only there and then.
    virtual void with_name(const std::function<void(const std::string& name)>& open) = 0;
    /// When all has been read: throws FileError where somebody wrote to the file meanwhile.
    virtual void require_unchanged() const {}
    /// As messages name it.
    [[nodiscard]] const std::string& name() const { return name_; }

  protected:
    explicit StoredBytes(std::string name) : name_(std::move(name)) {}

  private:
    std::string name_;
};

/// A whole number of at most eight bytes, the least significant first.
[[nodiscard]] inline std::uint64_t little_endian(std::string_view bytes) {
    std::uint64_t number = 0;
    for (std::size_t i = bytes.size(); i-- > 0;) number = number << 8U | static_cast<unsigned char>(bytes[i]);
    return number;
}

/// Fewer than `size` bytes where there are no more, or where they cannot be read: then errno says why, else
/// it is 0.
[[nodiscard]] std::size_t read_as_far(int descriptor, std::uint64_t offset, char* into, std::size_t size);

/// A file without a name in the folder for temporary files (TMPDIR). Throws FileError where there is no room.
class TemporaryBytes {
  public:
    TemporaryBytes();
    void put(std::string_view bytes);
    /// All that has been put.
    void copy_to(ByteSink& sink);
    /// Exactly `size` bytes that have been put, anywhere; putting goes on behind the last.
    void read_at(std::uint64_t offset, char* into, std::size_t size);
    /// As StoredBytes has it; a library may write to it, too.
    void with_name(const std::function<void(const std::string& name)>& open);

  private:
    std::unique_ptr<TemporaryFile> file_;
};

/// A file is read where it lies; a pipe is kept in a temporary file. `first_bytes` have been read from it.
[[nodiscard]] std::shared_ptr<StoredBytes> store_bytes(std::unique_ptr<ByteSource> source,
                                                       std::string first_bytes);

/// Throws DataError unless the part has this CRC-32. Reads it; says nothing in a build without zlib.
void require_checksum(StoredBytes& bytes, std::uint64_t offset, std::uint64_t size, std::uint32_t checksum);

/// What unpacks from a part of them, unpacked as far as it is asked for, into a temporary file. No more than
/// `most` bytes. With `checksum`, reading the last of `most` throws DataError unless it is theirs (CRC-32).
[[nodiscard]] std::shared_ptr<StoredBytes> unpack_part(std::shared_ptr<StoredBytes> packed,
                                                       std::uint64_t offset, std::uint64_t size, Deflate kind,
                                                       std::uint64_t most,
                                                       std::optional<std::uint32_t> checksum = {});

/// Appends the next `rows` numbers of one column, from its first row on. Throws DataError where they are not
/// there.
using NextNumbers = std::function<void(std::size_t rows, ColumnNumbers& into)>;

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
    std::function<NextNumbers(std::size_t column)> open;
    std::string read_as;  ///< in place of the path, where that says less than the container does
};

/// Numbers at equal distances in stored bytes.
[[nodiscard]] NextNumbers strided_numbers(std::shared_ptr<StoredBytes> bytes, std::uint64_t start,
                                          std::uint64_t stride, NpyField type);

/// How a column of a matrix is written.
enum class PathStyle {
    matlab,  ///< log.q(:,3), counted from 1
    numpy    ///< /log/q[:,2], counted from 0
};

/// A log made of arrays of one clock or one length: of those that --columns names, else of
/// those whose names say most. What --columns names of arrays with other clocks is joined by time. `extra`
/// goes to the list of contents only. Throws DataError where there is nothing to take, UsageError where
/// --columns names what does not fit together.
[[nodiscard]] ColumnLog columns_of_arrays(const std::shared_ptr<StoredBytes>& file, const std::string& format,
                                          PathStyle style, const std::vector<StoredArray>& arrays,
                                          const std::vector<ContentEntry>& extra, const ReadOptions& options);

/// How many of time, velocity, torque and position the names speak of, torque counting thrice; by which the
/// part of a container is chosen that is read.
[[nodiscard]] int names_tell(const std::vector<std::string>& names);

/// "tau (4000, float64)".
[[nodiscard]] std::string in_words(const ContentEntry& entry);

/// "f8" as people say it: "float64".
[[nodiscard]] std::string type_name(const NpyField& type);

/// Of an object that only MATLAB opens: its class, and the lines of MATLAB that save its numbers.
[[nodiscard]] std::string matlab_object_text(const std::string& name, const std::string& class_name);

}  // namespace ripplenotch
