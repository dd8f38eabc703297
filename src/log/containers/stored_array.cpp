// SPDX-License-Identifier: MIT
#include "log/containers/stored_array.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <set>

#include "log/columns/column_name.hpp"
#include "log/open.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

namespace {

constexpr std::size_t stored_piece = std::size_t{1} << 16;

[[noreturn]] void complain_of_end(const std::string& name, std::uint64_t offset, std::uint64_t size) {
    raise<DataError>(
        "{}: read up to byte {}, expected more than these {} bytes; the file is cut off or damaged, copy it "
        "again",
        name, offset, size);
}

[[noreturn]] void complain_of_sum(const std::string& name, std::uint32_t sum, std::uint32_t expected) {
    raise<DataError>(
        "{}: read numbers with the checksum {:08x}, expected {:08x}: the file is damaged, copy it again",
        name, sum, expected);
}

class FileBytes final : public StoredBytes {
  public:
    explicit FileBytes(std::unique_ptr<ByteSource> source)
        : StoredBytes(source->name()),
          source_(std::move(source)),
          descriptor_(source_->descriptor_by_place()) {}
    [[nodiscard]] std::uint64_t size() const override { return source_->size(); }
    void read_at(std::uint64_t offset, char* into, std::size_t size) override {
        if (offset > this->size()) complain_of_end(name(), offset, this->size());
        const std::size_t have = read_as_far(descriptor_, offset, into, size);
        if (have == size) return;
        if (errno != 0) raise<FileError>("{}: cannot read: {}", name(), std::strerror(errno));
        complain_of_end(name(), offset + have, this->size());
    }
    // Where it lies; a file that has lost its name, by which libraries look for it, is copied.
    void with_name(const std::function<void(const std::string&)>& open) override {
        struct stat status {};
        if (::fstat(descriptor_, &status) == 0 && status.st_nlink > 0)
            return open(fmt::format("/dev/fd/{}", descriptor_));
        TemporaryBytes copy;
        for (std::uint64_t at = 0; at < size(); at += stored_piece)
            copy.put(
                text_at(at, static_cast<std::size_t>(std::min<std::uint64_t>(stored_piece, size() - at))));
        copy.with_name(open);
    }
    void require_unchanged() const override { source_->require_unchanged(); }

  private:
    std::unique_ptr<ByteSource> source_;
    int descriptor_;
};

class KeptBytes final : public StoredBytes {
  public:
    KeptBytes(ByteSource& source, std::string piece) : StoredBytes(source.name()) {
        for (; !piece.empty(); piece.clear(), read_on(source, piece, stored_piece)) {
            bytes_.put(piece);
            size_ += piece.size();
        }
    }
    [[nodiscard]] std::uint64_t size() const override { return size_; }
    void read_at(std::uint64_t offset, char* into, std::size_t size) override {
        if (offset > size_ || size > size_ - offset) complain_of_end(name(), offset, size_);
        bytes_.read_at(offset, into, size);
    }
    void with_name(const std::function<void(const std::string&)>& open) override { bytes_.with_name(open); }

  private:
    TemporaryBytes bytes_;
    std::uint64_t size_ = 0;
};

class UnpackedPart final : public StoredBytes {
  public:
    UnpackedPart(std::shared_ptr<StoredBytes> packed, std::uint64_t offset, std::uint64_t size, Deflate kind,
                 std::uint64_t most, std::optional<std::uint32_t> checksum)
        : StoredBytes(packed->name()),
          packed_(std::move(packed)),
          at_(offset),
          end_(offset + size),
          most_(most),
          checksum_(checksum),
          unpacker_(make_inflater(kind, name())) {}
    [[nodiscard]] std::uint64_t size() const override { return 0; }
    void read_at(std::uint64_t offset, char* into, std::size_t size) override {
        if (size > most_ || offset > most_ - size) complain_of_end(name(), offset, most_);
        while (have_ < offset + size) unpack_piece();
        bytes_.read_at(offset, into, size);
    }
    void with_name(const std::function<void(const std::string&)>& open) override { bytes_.with_name(open); }
    void require_unchanged() const override { packed_->require_unchanged(); }

  private:
    void unpack_piece() {
        if (!room_) room_ = std::make_unique_for_overwrite<char[]>(stored_piece);
        const std::span<char> unpacked(room_.get(), stored_piece);
        if (left_.empty() && at_ < end_) {
            piece_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(stored_piece, end_ - at_)));
            packed_->read_at(at_, piece_.data(), piece_.size());
            at_ += piece_.size();
            left_ = piece_;
        }
        const Unpacker::Step step = unpacker_->step(left_, unpacked);
        if (!step.damage.empty())
            raise<DataError>("{}: read up to byte {}, expected packed numbers: {}", name(), at_, step.damage);
        left_.remove_prefix(step.taken);
        have_ += step.given;
        if (step.given == 0 && (unpacker_->complete() || (step.taken == 0 && at_ == end_)))
            complain_of_end(name(), at_, packed_->size());
        if (have_ > most_)
            raise<DataError>("{}: read more than {} bytes packed into one array, expected no more", name(),
                             most_);
        const std::string_view fresh(unpacked.data(), step.given);
        if (checksum_) sum_ = crc32_of(fresh, sum_.value_or(0));
        if (checksum_ && have_ == most_ && sum_ && *sum_ != *checksum_)
            complain_of_sum(name(), *sum_, *checksum_);
        bytes_.put(fresh);
    }

    std::shared_ptr<StoredBytes> packed_;
    std::uint64_t at_, end_, most_, have_ = 0;
    std::optional<std::uint32_t> checksum_, sum_;
    std::unique_ptr<Unpacker> unpacker_;
    std::string piece_;
    std::string_view left_;         ///< of the piece
    std::unique_ptr<char[]> room_;  ///< for what comes out of it
    TemporaryBytes bytes_;
};

constexpr std::uint64_t most_columns = 64;
constexpr std::size_t gathered_at_once = std::size_t{1} << 18;

}  // namespace

std::size_t read_as_far(int descriptor, std::uint64_t offset, char* into, std::size_t size) {
    std::size_t have = 0;
    errno = 0;
    while (have < size) {
        const ssize_t got = ::pread(descriptor, into + have, size - have, static_cast<off_t>(offset + have));
        if (got < 0 && errno == EINTR) {
            errno = 0;
            continue;
        }
        if (got <= 0) break;
        have += static_cast<std::size_t>(got);
    }
    return have;
}

TemporaryBytes::TemporaryBytes()
    : file_(std::make_unique<TemporaryFile>(temporary_folder() + "/ripplenotch-rows", std::nullopt)) {}

void TemporaryBytes::put(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t taken = ::write(file_->descriptor(), bytes.data(), bytes.size());
        if (taken < 0 && errno == EINTR) continue;
        if (taken < 0)
            raise<FileError>("cannot write to a temporary file; check the space in the temporary folder");
        bytes.remove_prefix(static_cast<std::size_t>(taken));
    }
}

void TemporaryBytes::read_at(std::uint64_t offset, char* into, std::size_t size) {
    if (read_as_far(file_->descriptor(), offset, into, size) < size)
        raise<FileError>("cannot read a temporary file back");
}

void TemporaryBytes::copy_to(ByteSink& sink) {
    std::vector<char> piece(std::size_t{1} << 20);
    for (std::uint64_t at = 0;;) {
        const std::size_t got = read_as_far(file_->descriptor(), at, piece.data(), piece.size());
        if (errno != 0) raise<FileError>("cannot read a temporary file back: {}", std::strerror(errno));
        if (got == 0) return;
        sink.write({piece.data(), got});
        at += got;
    }
}

void TemporaryBytes::with_name(const std::function<void(const std::string&)>& open) {
    open(file_->name_for_a_moment(temporary_folder() + "/ripplenotch-rows"));
    file_->forget_name();
}

void require_checksum(StoredBytes& bytes, std::uint64_t offset, std::uint64_t size, std::uint32_t checksum) {
    std::optional<std::uint32_t> sum = 0;
    for (std::uint64_t done = 0; done < size && sum; done += stored_piece) {
        const auto length = static_cast<std::size_t>(std::min<std::uint64_t>(stored_piece, size - done));
        sum = crc32_of(bytes.text_at(offset + done, length), *sum);
    }
    if (sum && *sum != checksum) complain_of_sum(bytes.name(), *sum, checksum);
}

std::shared_ptr<StoredBytes> store_bytes(std::unique_ptr<ByteSource> source, std::string first_bytes) {
    if (source->by_place()) return std::make_shared<FileBytes>(std::move(source));
    return std::make_shared<KeptBytes>(*source, std::move(first_bytes));
}

std::shared_ptr<StoredBytes> unpack_part(std::shared_ptr<StoredBytes> packed, std::uint64_t offset,
                                         std::uint64_t size, Deflate kind, std::uint64_t most,
                                         std::optional<std::uint32_t> checksum) {
    return std::make_shared<UnpackedPart>(std::move(packed), offset, size, kind, most, checksum);
}

NextNumbers strided_numbers(std::shared_ptr<StoredBytes> bytes, std::uint64_t start, std::uint64_t stride,
                            NpyField type) {
    type.offset = 0;
    return [bytes = std::move(bytes), at = start, stride, type = std::move(type), span = std::string()](
               std::size_t rows, ColumnNumbers& into) mutable {
        const std::size_t at_once = std::max<std::size_t>(1, gathered_at_once / stride);
        for (std::size_t done = 0; done < rows;) {
            const std::size_t count = std::min(at_once, rows - done);
            span.resize((count - 1) * stride + type.size);
            bytes->read_at(at, span.data(), span.size());
            load_column(span.data(), stride, type, count, into);
            at += count * stride;
            done += count;
        }
    };
}

std::optional<ArrayShape> shape_over_time(const std::vector<std::uint64_t>& dimensions) {
    std::vector<std::uint64_t> sides;
    for (const std::uint64_t side : dimensions) {
        if (side == 0) return std::nullopt;
        if (side > 1) sides.push_back(side);
    }
    if (sides.empty() || sides.size() > 2) return std::nullopt;
    if (sides.size() == 1) return ArrayShape{sides[0], 1, true, dimensions.front() == sides[0]};
    const bool first = sides[0] >= sides[1];
    const std::uint64_t rows = first ? sides[0] : sides[1], columns = first ? sides[1] : sides[0];
    if (columns > most_columns || dimensions.size() > 2) return std::nullopt;
    return ArrayShape{rows, columns, false, first};
}

int names_tell(const std::vector<std::string>& names) {
    std::set<Role> roles;
    for (const std::string& name : names) {
        const ColumnName column = read_column_name(name);
        if (!column.reference) roles.insert(column.role);
    }
    roles.erase(Role::other);
    return static_cast<int>(roles.size()) + (roles.count(Role::torque) > 0 ? 2 : 0);
}

std::string in_words(const ContentEntry& entry) {
    return fmt::format("{} ({}{}{})", entry.path, entry.shape, entry.shape.empty() ? "" : ", ", entry.type);
}

std::string type_name(const NpyField& type) {
    const std::string_view kind = type.kind == 'f' ? "float" : type.kind == 'i' ? "int" : "uint";
    return fmt::format("{}{}{}", kind, 8 * type.size, type.big_endian ? ", big-endian" : "");
}

std::string matlab_object_text(const std::string& name, const std::string& class_name) {
    const std::string save = "save('run.mat', 't', 'tau')";
    if (class_name == "timeseries")
        return fmt::format("an object of class timeseries; in MATLAB: t = {0}.Time; tau = {0}.Data; {1}",
                           name, save);
    if (class_name == "table" || class_name == "timetable") {
        const bool timed = class_name == "timetable";
        return fmt::format(
            "an object of class {}; in MATLAB: s = table2struct({}, 'ToScalar', true); save('run.mat', "
            "'-struct', 's')",
            class_name, timed ? fmt::format("timetable2table({})", name) : name);
    }
    if (class_name.starts_with("Simulink."))
        return fmt::format(
            "an object of class {0}; in MATLAB, for each signal: x = {1}.get('tau').Values; t = x.Time; tau "
            "= x.Data; {2}",
            class_name, class_name == "Simulink.SimulationOutput" ? name + ".logsout" : name, save);
    return fmt::format("an object of class {}; in MATLAB, save its numbers as vectors: {}", class_name, save);
}

}  // namespace ripplenotch
