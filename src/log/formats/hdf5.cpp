// SPDX-License-Identifier: MIT
// HDF5 files, and MAT files of version 7.3, which are such, by libhdf5.

#if defined(RIPPLENOTCH_HAS_HDF5)
#define H5_USE_110_API
#include <hdf5.h>
#endif

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <bit>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "log/containers/stored_array.hpp"
#include "log/open.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr std::string_view magic = "\x89HDF\r\n\x1a\n", matlab_head = "MATLAB 7.3";
constexpr std::array<std::string_view, 2> hdf5_extensions = {".h5", ".hdf5"};

// MATLAB puts a head of text in front.
bool sniff(std::string_view bytes) { return bytes.starts_with(magic) || bytes.starts_with(matlab_head); }

#if defined(RIPPLENOTCH_HAS_HDF5)

// libhdf5's objects, closed when they go. The one door to the library.
// The names of version 1.10, which later ones keep.

/// A number of libhdf5, negative where there is none; closed with its last owner.
class Hdf5Handle {
  public:
    Hdf5Handle() = default;
    Hdf5Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id) {
        if (id >= 0) keeper_ = std::shared_ptr<void>(nullptr, [id, close](void* /*none*/) { close(id); });
    }
    [[nodiscard]] hid_t id() const { return id_; }
    [[nodiscard]] bool good() const { return id_ >= 0; }

  private:
    hid_t id_ = -1;
    std::shared_ptr<void> keeper_;
};

// Without locks, which many network file systems refuse: a file that changes while it is read is noticed
// without them.
Hdf5Handle access_of_files() {
    Hdf5Handle access(::H5Pcreate(H5P_FILE_ACCESS), ::H5Pclose);
#if H5_VERSION_GE(1, 10, 7)
    ::H5Pset_file_locking(access.id(), false, true);
#endif
    return access;
}

// Numbers of an HDF5 dataset, a column at a time.

/// The file that datasets are read from.
struct Hdf5File {
    std::shared_ptr<StoredBytes> bytes;
    Hdf5Handle file;
};

/// Numbers in memory, and how they are asked for.
struct Hdf5Memory {
    NpyField field;
    Hdf5Handle type;        ///< one number, an array of them, or a record of one member
    std::size_t count = 1;  ///< numbers that come for each row
};

hid_t hdf5_native(const NpyField& field) {
    if (field.kind == 'f') return field.size == 4 ? H5T_NATIVE_FLOAT : H5T_NATIVE_DOUBLE;
    const bool is_signed = field.kind == 'i';
    switch (field.size) {
        case 1:
            return is_signed ? H5T_NATIVE_INT8 : H5T_NATIVE_UINT8;
        case 2:
            return is_signed ? H5T_NATIVE_INT16 : H5T_NATIVE_UINT16;
        case 4:
            return is_signed ? H5T_NATIVE_INT32 : H5T_NATIVE_UINT32;
        default:
            return is_signed ? H5T_NATIVE_INT64 : H5T_NATIVE_UINT64;
    }
}

// A number of the file as the processor has it; none for text, references, and what is wider than 8 bytes.
std::optional<NpyField> hdf5_number(hid_t type) {
    const H5T_class_t kind = ::H5Tget_class(type);
    const std::size_t size = ::H5Tget_size(type);
    if ((kind != H5T_INTEGER && kind != H5T_FLOAT) || size == 0 || size > 8) return std::nullopt;
    NpyField field;
    field.big_endian = std::endian::native == std::endian::big;
    field.kind = kind == H5T_FLOAT ? 'f' : ::H5Tget_sign(type) == H5T_SGN_NONE ? 'u' : 'i';
    field.size = kind == H5T_FLOAT ? (size <= 4 ? 4 : 8) : std::bit_ceil(size);
    return field;
}

/// A dataset of one dimension or two.
struct Hdf5Dataset {
    std::shared_ptr<Hdf5File> file;
    Hdf5Handle dataset;
    std::string path;
    Hdf5Memory memory;
    std::size_t dimensions, time_dimension;
};

// The numbers of a column, or one number of an array in every row, from row `at` on.
void read_dataset(const Hdf5Dataset& from, std::size_t column, std::uint64_t at, std::size_t rows,
                  ColumnNumbers& into) {
    const Hdf5Memory& memory = from.memory;
    std::vector<hsize_t> start(from.dimensions, 0), count(from.dimensions, 1);
    start[from.time_dimension] = at;
    count[from.time_dimension] = rows;
    if (memory.count == 1 && from.dimensions == 2) start[1 - from.time_dimension] = column;
    const Hdf5Handle space(::H5Dget_space(from.dataset.id()), ::H5Sclose);
    const hsize_t length = rows;
    const Hdf5Handle memory_space(::H5Screate_simple(1, &length, nullptr), ::H5Sclose);
    ::H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr);
    const std::size_t size = memory.field.size;
    std::string read(rows * memory.count * size, '\0');
    if (::H5Dread(from.dataset.id(), memory.type.id(), memory_space.id(), space.id(), H5P_DEFAULT,
                  read.data()) < 0) {
        raise<DataError>("{}: read row {} of {}, expected {} rows of numbers; the file is cut off or damaged",
                         from.file->bytes->name(), at + 1, from.path, rows);
    }
    const std::size_t picked = memory.count > 1 ? column * size : 0;
    load_column(read.data() + picked, memory.count * size, memory.field, rows, into);
}

constexpr std::size_t rows_of_a_chunk = 16384;  // rows

/// A new file with a dataset of float64 for each column. The library goes back and forth in what it writes,
/// so that the file waits under no name until it is whole.
class Hdf5TableWriter final : public TableWriter {
  public:
    Hdf5TableWriter(ByteSink& sink, std::span<const std::string> names, const WriteOptions& /*options*/)
        : sink_(sink), names_(names.begin(), names.end()), waiting_(names.size()) {
        ::H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
        scratch_.with_name([this](const std::string& name) {
            const Hdf5Handle access = access_of_files();
            file_ = {::H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), ::H5Fclose};
        });
        if (!file_.good()) raise<FileError>("cannot write to a temporary file; check the temporary folder");
    }
    // A chunk at a time, wherever the caller cuts: so the bytes are alike.
    void rows(std::span<const std::span<const double>> columns) override {
        for (std::size_t c = 0; c < columns.size(); ++c)
            waiting_[c].insert(waiting_[c].end(), columns[c].begin(), columns[c].end());
        while (waiting_.front().size() >= rows_of_a_chunk) write(rows_of_a_chunk);
    }
    void end() override {
        write(waiting_.front().size());
        datasets_.clear();
        require(::H5Fflush(file_.id(), H5F_SCOPE_LOCAL) >= 0);
        file_ = {};
        scratch_.copy_to(sink_);
    }

  private:
    static void require(bool written) {
        if (!written)
            raise<FileError>("cannot write to a temporary file; check the space in the temporary folder");
    }
    void write(hsize_t count) {
        if (datasets_.empty()) make_datasets(std::max<hsize_t>(1, count));
        if (count == 0) return;
        const hsize_t first = rows_;
        rows_ += count;
        const Hdf5Handle memory(::H5Screate_simple(1, &count, nullptr), ::H5Sclose);
        for (std::size_t c = 0; c < datasets_.size(); ++c) {
            require(::H5Dset_extent(datasets_[c].id(), &rows_) >= 0);
            const Hdf5Handle place(::H5Dget_space(datasets_[c].id()), ::H5Sclose);
            ::H5Sselect_hyperslab(place.id(), H5S_SELECT_SET, &first, nullptr, &count, nullptr);
            require(::H5Dwrite(datasets_[c].id(), H5T_NATIVE_DOUBLE, memory.id(), place.id(), H5P_DEFAULT,
                               waiting_[c].data()) >= 0);
            waiting_[c].erase(waiting_[c].begin(), waiting_[c].begin() + static_cast<std::ptrdiff_t>(count));
        }
    }
    // Without the hour, so that the same numbers are the same bytes.
    void make_datasets(hsize_t chunk) {
        const hsize_t none = 0, unlimited = H5S_UNLIMITED;
        const Hdf5Handle creation(::H5Pcreate(H5P_DATASET_CREATE), ::H5Pclose),
            space(::H5Screate_simple(1, &none, &unlimited), ::H5Sclose);
        ::H5Pset_chunk(creation.id(), 1, &chunk);
        ::H5Pset_obj_track_times(creation.id(), false);
        for (std::string name : names_) {
            std::ranges::replace(name, '/', '_');
            datasets_.emplace_back(::H5Dcreate2(file_.id(), name.c_str(), H5T_IEEE_F64LE, space.id(),
                                                H5P_DEFAULT, creation.id(), H5P_DEFAULT),
                                   ::H5Dclose);
            require(datasets_.back().good());
        }
    }

    ByteSink& sink_;
    std::vector<std::string> names_;
    std::vector<std::vector<double>> waiting_;  ///< by column: rows of a chunk that is not full
    TemporaryBytes scratch_;                    ///< for the library to write and us to read
    Hdf5Handle file_;
    std::vector<Hdf5Handle> datasets_;  ///< closed before the file
    hsize_t rows_ = 0;
};

constexpr std::size_t largest_hdf5_chunk = std::size_t{1} << 28, usual_cache = std::size_t{1} << 22,
                      largest_cache = std::size_t{1} << 25;
constexpr std::size_t most_hdf5_things = 100000;

std::string text_attribute(hid_t object, const char* name) {
    if (::H5Aexists(object, name) <= 0) return {};
    const Hdf5Handle attribute(::H5Aopen(object, name, H5P_DEFAULT), ::H5Aclose);
    const Hdf5Handle type(::H5Aget_type(attribute.id()), ::H5Tclose),
        space(::H5Aget_space(attribute.id()), ::H5Sclose);
    if (::H5Tget_class(type.id()) != H5T_STRING || ::H5Sget_simple_extent_npoints(space.id()) != 1) return {};
    if (::H5Tis_variable_str(type.id()) > 0) {
        char* text = nullptr;
        if (::H5Aread(attribute.id(), type.id(), &text) < 0 || text == nullptr) return {};
        const std::string copy = text;
        ::H5free_memory(text);
        return copy;
    }
    std::string text(::H5Tget_size(type.id()), '\0');
    if (text.size() > 4096 || ::H5Aread(attribute.id(), type.id(), text.data()) < 0) return {};
    return text.substr(0, text.find_last_not_of(std::string_view("\0 ", 2)) + 1).c_str();
}

/// Links and numbers that lie in other files are never followed, and no filter is loaded. With `matlab`,
/// paths are as MATLAB writes them ("log.q_dot") and text, cells and objects are left out.
class Hdf5Walk {
  public:
    Hdf5Walk(const std::shared_ptr<StoredBytes>& bytes, bool matlab)
        : matlab_(matlab), file_(std::make_shared<Hdf5File>()) {
        ::H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
        ::H5PLset_loading_state(0);  // a file must not say which code is run
        file_->bytes = bytes;
        bytes->with_name([this](const std::string& name) {
            const Hdf5Handle access = access_of_files();
            file_->file = {::H5Fopen(name.c_str(), H5F_ACC_RDONLY, access.id()), ::H5Fclose};
        });
        if (!file_->file.good())
            raise<DataError>(
                "{}: read an HDF5 file that libhdf5 cannot open, expected a whole one; the file is cut off, "
                "damaged, or still being written",
                bytes->name());
        const herr_t walked = ::H5Lvisit(file_->file.id(), H5_INDEX_NAME, H5_ITER_INC, visit, this);
        if (failure_) std::rethrow_exception(failure_);
        if (walked < 0)
            raise<DataError>(
                "{}: read a part of the list of datasets, expected all of it; the file is damaged",
                bytes->name());
    }
    std::vector<StoredArray> arrays;  ///< datasets of one dimension or two, members of compound types
    std::vector<ContentEntry>
        others;  ///< "outside of the file, not followed", "packed by a filter that is not here"

  private:
    static herr_t visit(hid_t group, const char* name, const H5L_info_t* info, void* walk) {
        auto& self = *static_cast<Hdf5Walk*>(walk);
        try {
            self.take_link(group, name, *info);
            return 0;
        } catch (...) {  // libhdf5 is C
            self.failure_ = std::current_exception();
            return -1;
        }
    }
    void take_link(hid_t group, const std::string& name, const H5L_info_t& info) {
        if (++things_ > most_hdf5_things)
            raise<DataError>("{}: read more than 100000 links, expected a log", file_->bytes->name());
        if (matlab_ && name.starts_with('#')) return;  // what cells and objects are made of
        if (info.type == H5L_TYPE_EXTERNAL)
            return add_other(name, "", "a link to another file, not followed");
        if (info.type != H5L_TYPE_HARD) return;
        const Hdf5Handle object(::H5Oopen(group, name.c_str(), H5P_DEFAULT), ::H5Oclose);
        if (object.good() && ::H5Iget_type(object.id()) == H5I_DATASET) take_dataset(group, name);
    }
    void take_dataset(hid_t group, const std::string& name) {
        const Hdf5Handle plain(::H5Dopen2(group, name.c_str(), H5P_DEFAULT), ::H5Dclose);
        const Hdf5Handle layout(::H5Dget_create_plist(plain.id()), ::H5Pclose),
            space(::H5Dget_space(plain.id()), ::H5Sclose);
        std::array<hsize_t, H5S_MAX_RANK> sides{};
        const int rank = ::H5Sget_simple_extent_dims(space.id(), sides.data(), nullptr);
        std::vector<std::uint64_t> dimensions(sides.begin(), sides.begin() + std::max(rank, 0));
        const std::string words = fmt::format("{}", fmt::join(dimensions, " x "));
        const std::string matlab_class = text_attribute(plain.id(), "MATLAB_class");
        if (matlab_ &&
            (matlab_class.empty() || matlab_class == "char" || ::H5Aexists(plain.id(), "MATLAB_empty") > 0))
            return;
        if (matlab_ && ::H5Aexists(plain.id(), "MATLAB_object_decode") > 0)
            return add_other(name, "", matlab_object_text(name, matlab_class));
        if (matlab_ &&
            (matlab_class == "cell" || matlab_class == "logical" || matlab_class == "function_handle"))
            return add_other(name, words, matlab_class);
        if (::H5Pget_layout(layout.id()) == H5D_VIRTUAL || ::H5Pget_external_count(layout.id()) > 0)
            return add_other(name, words, "numbers outside of the file, not followed");
        if (::H5Pget_layout(layout.id()) == H5D_CHUNKED && ::H5Pall_filters_avail(layout.id()) <= 0)
            return add_other(name, words, "packed by a filter that is not here");
        const Hdf5Handle type(::H5Dget_type(plain.id()), ::H5Tclose);
        if (chunk_bytes(layout.id(), type.id(), dimensions.size()) > largest_hdf5_chunk)
            return add_other(name, words, "in chunks of more than 256 MiB");
        const auto shape = shape_over_time(dimensions);
        const bool compound = ::H5Tget_class(type.id()) == H5T_COMPOUND;
        if (!shape || shape->rows < 2 || (compound && !shape->vector)) {
            if (hdf5_number(type.id())) add_other(name, words, "numbers");
            return;
        }
        if (is_hollow(plain.id(), type.id(), *shape))
            return add_other(name, words, "numbers that are not in the file");
        const auto dataset = reopened(group, name, chunk_bytes(layout.id(), type.id(), dimensions.size()));
        const std::string unit = unit_of(plain.id());
        if (compound) return take_members(name, *shape, dataset, type.id(), dimensions);
        if (const auto field = hdf5_number(type.id())) {
            Hdf5Memory memory{*field, Hdf5Handle(::H5Tcopy(hdf5_native(*field)), ::H5Tclose), 1};
            add_array(path_of(name), name, *shape, dataset, memory, dimensions, unit);
        } else {
            add_other(name, words, ::H5Tget_class(type.id()) == H5T_STRING ? "text" : "no numbers");
        }
    }
    void take_members(const std::string& name, const ArrayShape& shape, const Hdf5Handle& dataset, hid_t type,
                      const std::vector<std::uint64_t>& dimensions) {
        const int members = ::H5Tget_nmembers(type);
        for (int m = 0; m < members; ++m) {
            char* const raw = ::H5Tget_member_name(type, static_cast<unsigned>(m));
            const std::string member = raw;
            ::H5free_memory(raw);
            const Hdf5Handle own(::H5Tget_member_type(type, static_cast<unsigned>(m)), ::H5Tclose);
            const bool array = ::H5Tget_class(own.id()) == H5T_ARRAY;
            const Hdf5Handle base(array ? ::H5Tget_super(own.id()) : ::H5Tcopy(own.id()), ::H5Tclose);
            const auto field = hdf5_number(base.id());
            hsize_t count = 1;
            if (!field || (array && (::H5Tget_array_ndims(own.id()) != 1 ||
                                     ::H5Tget_array_dims2(own.id(), &count) < 0 || count > 64)))
                continue;
            const Hdf5Handle inner(
                array ? ::H5Tarray_create2(hdf5_native(*field), 1, &count) : ::H5Tcopy(hdf5_native(*field)),
                ::H5Tclose);
            Hdf5Memory memory{*field, Hdf5Handle(::H5Tcreate(H5T_COMPOUND, field->size * count), ::H5Tclose),
                              count};
            ::H5Tinsert(memory.type.id(), member.c_str(), 0, inner.id());
            ArrayShape own_shape = shape;
            own_shape.columns = count;
            own_shape.vector = !array;
            own_shape.time_is_first = true;
            add_array(path_of(name) + "." + member, name, own_shape, dataset, memory, dimensions, "");
        }
    }
    void add_array(const std::string& path, const std::string& name, ArrayShape shape,
                   const Hdf5Handle& dataset, const Hdf5Memory& memory,
                   const std::vector<std::uint64_t>& dimensions, const std::string& unit) {
        const auto longest = std::ranges::max_element(dimensions);
        const auto time_dimension = static_cast<std::size_t>(longest - dimensions.begin());
        StoredArray array{path, shape, memory.field, unit, {}, ""};
        const auto from = std::make_shared<const Hdf5Dataset>(
            Hdf5Dataset{file_, dataset, "/" + name, memory, dimensions.size(), time_dimension});
        array.open = [from](std::size_t column) {
            return [from, column, at = std::uint64_t{0}](std::size_t rows, ColumnNumbers& into) mutable {
                read_dataset(*from, column, std::exchange(at, at + rows), rows, into);
            };
        };
        // MATLAB counts dimensions from the other end.
        if (matlab_) array.shape.time_is_first = !array.shape.time_is_first;
        arrays.push_back(std::move(array));
    }
    // What was never written reads as zeros without end.
    static bool is_hollow(hid_t dataset, hid_t type, const ArrayShape& shape) {
        constexpr double unasked = 64e6, most_for_one = 2000.0;
        const double bytes = static_cast<double>(shape.rows) * static_cast<double>(shape.columns) *
                             static_cast<double>(::H5Tget_size(type));
        return bytes > unasked && bytes > most_for_one * static_cast<double>(::H5Dget_storage_size(dataset));
    }
    // With room for a chunk that is longer than usual, or it is unpacked anew for every column.
    static Hdf5Handle reopened(hid_t group, const std::string& name, std::size_t chunk) {
        const Hdf5Handle access(::H5Pcreate(H5P_DATASET_ACCESS), ::H5Pclose);
        ::H5Pset_chunk_cache(access.id(), 521, std::clamp(2 * chunk, usual_cache, largest_cache), 1.0);
        return Hdf5Handle(::H5Dopen2(group, name.c_str(), access.id()), ::H5Dclose);
    }
    static std::size_t chunk_bytes(hid_t layout, hid_t type, std::size_t rank) {
        if (::H5Pget_layout(layout) != H5D_CHUNKED) return 0;
        std::array<hsize_t, H5S_MAX_RANK> sides{};
        std::size_t bytes = ::H5Tget_size(type);
        if (::H5Pget_chunk(layout, static_cast<int>(rank), sides.data()) < 0) return 0;
        for (std::size_t i = 0; i < rank; ++i)
            bytes = bytes > largest_hdf5_chunk ? bytes : bytes * static_cast<std::size_t>(sides[i]);
        return bytes;
    }
    static std::string unit_of(hid_t dataset) {
        for (const char* const name : {"units", "unit", "Units", "Unit"}) {
            if (std::string unit = text_attribute(dataset, name); !unit.empty()) return unit;
        }
        return {};
    }
    std::string path_of(const std::string& name) const {
        if (!matlab_) return "/" + name;
        std::string path = name;
        std::ranges::replace(path, '/', '.');
        return path;
    }
    void add_other(const std::string& name, const std::string& shape, const std::string& what) {
        others.push_back({path_of(name), shape, what, "", {}, false});
    }

    bool matlab_;
    std::shared_ptr<Hdf5File> file_;
    std::size_t things_ = 0;
    std::exception_ptr failure_;
};

ColumnLog make_hdf5(std::unique_ptr<ByteSource> source, std::string first_bytes, const ReadOptions& options) {
    const bool matlab = first_bytes.starts_with(matlab_head);
    const auto file = store_bytes(std::move(source), std::move(first_bytes));
    const Hdf5Walk found(file, matlab);
    return columns_of_arrays(file, "hdf5", matlab ? PathStyle::matlab : PathStyle::numpy, found.arrays,
                             found.others, options);
}

#endif

}  // namespace

const LogFormat formats::hdf5 {
    .name = "hdf5", .summary = "HDF5 files, and MATLAB's of version 7.3: datasets by path",
    .extensions = hdf5_extensions, .binary = true,
#if defined(RIPPLENOTCH_HAS_HDF5)
    .sniff = sniff, .columns = make_hdf5, .table = table_of<Hdf5TableWriter>,
#else
    .lacks = "libhdf5", .sniff = sniff,
#endif
};

}  // namespace ripplenotch
