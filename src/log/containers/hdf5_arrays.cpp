// SPDX-License-Identifier: MIT
#include "log/containers/hdf5_arrays.hpp"

#include "ripplenotch/core/error.hpp"

#if defined(RIPPLENOTCH_HAS_HDF5)

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <bit>
#include <exception>

#include "log/containers/hdf5_files.hpp"
#include "log/containers/hdf5_numbers.hpp"

namespace ripplenotch {
namespace {

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

class Hdf5Walk {
  public:
    Hdf5Walk(const std::shared_ptr<StoredBytes>& bytes, bool matlab)
        : matlab_(matlab), file_(std::make_shared<Hdf5File>()) {
        ::H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
        ::H5PLset_loading_state(0);  // a file must not say which code is run
        file_->bytes = bytes;
        file_->file = open_hdf5(*bytes);
        if (!file_->file.good())
            raise<DataError>(
                "{}: read an HDF5 file that libhdf5 cannot open, expected a whole one; the file is cut off, "
                "damaged, or "
                "still being written",
                bytes->name());
        const herr_t walked = ::H5Lvisit(file_->file.id(), H5_INDEX_NAME, H5_ITER_INC, visit, this);
        if (failure_) std::rethrow_exception(failure_);
        if (walked < 0)
            raise<DataError>(
                "{}: read a part of the list of datasets, expected all of it; the file is damaged",
                bytes->name());
    }
    Hdf5Contents found;

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
            Hdf5Memory memory{*field,
                              std::make_shared<Hdf5Handle>(::H5Tcopy(hdf5_native(*field)), ::H5Tclose), 1};
            add_array(path_of(name), *shape, dataset, memory, dimensions, unit);
        } else {
            add_other(name, words, ::H5Tget_class(type.id()) == H5T_STRING ? "text" : "no numbers");
        }
    }
    void take_members(const std::string& name, const ArrayShape& shape,
                      const std::shared_ptr<Hdf5Handle>& dataset, hid_t type,
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
            Hdf5Memory memory{
                *field,
                std::make_shared<Hdf5Handle>(::H5Tcreate(H5T_COMPOUND, field->size * count), ::H5Tclose),
                count};
            ::H5Tinsert(memory.type->id(), member.c_str(), 0, inner.id());
            ArrayShape own_shape = shape;
            own_shape.columns = count;
            own_shape.vector = !array;
            own_shape.time_is_first = true;
            add_array(path_of(name) + "." + member, own_shape, dataset, memory, dimensions, "");
        }
    }
    void add_array(const std::string& path, ArrayShape shape, const std::shared_ptr<Hdf5Handle>& dataset,
                   const Hdf5Memory& memory, const std::vector<std::uint64_t>& dimensions,
                   const std::string& unit) {
        const auto longest = std::max_element(dimensions.begin(), dimensions.end());
        const auto time_dimension = static_cast<std::size_t>(longest - dimensions.begin());
        StoredArray array{path, shape, memory.field, unit, {}, ""};
        array.open = [file = file_, dataset, memory, rank = dimensions.size(),
                      time_dimension](std::size_t column) {
            return hdf5_column(file, dataset, memory, rank, time_dimension, column);
        };
        // MATLAB counts dimensions from the other end.
        if (matlab_) array.shape.time_is_first = !array.shape.time_is_first;
        found.arrays.push_back(std::move(array));
    }
    // What was never written reads as zeros without end.
    static bool is_hollow(hid_t dataset, hid_t type, const ArrayShape& shape) {
        constexpr double unasked = 64e6, most_for_one = 2000.0;
        const double bytes = static_cast<double>(shape.rows) * static_cast<double>(shape.columns) *
                             static_cast<double>(::H5Tget_size(type));
        return bytes > unasked && bytes > most_for_one * static_cast<double>(::H5Dget_storage_size(dataset));
    }
    // With room for a chunk that is longer than usual, or it is unpacked anew for every column.
    static std::shared_ptr<Hdf5Handle> reopened(hid_t group, const std::string& name, std::size_t chunk) {
        const Hdf5Handle access(::H5Pcreate(H5P_DATASET_ACCESS), ::H5Pclose);
        ::H5Pset_chunk_cache(access.id(), 521, std::clamp(2 * chunk, usual_cache, largest_cache), 1.0);
        return std::make_shared<Hdf5Handle>(::H5Dopen2(group, name.c_str(), access.id()), ::H5Dclose);
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
        std::replace(path.begin(), path.end(), '/', '.');
        return path;
    }
    void add_other(const std::string& name, const std::string& shape, const std::string& what) {
        found.others.push_back({path_of(name), shape, what, "", {}, false});
    }

    bool matlab_;
    std::shared_ptr<Hdf5File> file_;
    std::size_t things_ = 0;
    std::exception_ptr failure_;
};

}  // namespace

Hdf5Contents find_hdf5_arrays(const std::shared_ptr<StoredBytes>& file, bool matlab) {
    return std::move(Hdf5Walk(file, matlab).found);
}

}  // namespace ripplenotch
#else
namespace ripplenotch {

Hdf5Contents find_hdf5_arrays(const std::shared_ptr<StoredBytes>& file, bool /*matlab*/) {
    raise<UsageError>("{}: this build was made without libhdf5; install it and build again", file->name());
}

}  // namespace ripplenotch
#endif
