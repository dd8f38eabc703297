// SPDX-License-Identifier: MIT
#if defined(RIPPLENOTCH_HAS_HDF5)

#include "log/containers/hdf5_numbers.hpp"

#include <algorithm>
#include <bit>

#include "log/records/strided_copy.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

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

namespace {

class DatasetCursor final : public ColumnCursor {
  public:
    DatasetCursor(std::shared_ptr<Hdf5File> file, std::shared_ptr<Hdf5Handle> dataset, Hdf5Memory memory,
                  std::size_t dimensions, std::size_t time_dimension, std::size_t column)
        : file_(std::move(file)),
          dataset_(std::move(dataset)),
          memory_(std::move(memory)),
          dimensions_(dimensions),
          time_dimension_(time_dimension),
          column_(column) {}
    void read(std::size_t rows, char* into) override {
        std::vector<hsize_t> start(dimensions_, 0), count(dimensions_, 1);
        start[time_dimension_] = at_;
        count[time_dimension_] = rows;
        const bool picks = memory_.count > 1;
        if (!picks && dimensions_ == 2) start[1 - time_dimension_] = column_;
        const Hdf5Handle space(::H5Dget_space(dataset_->id()), ::H5Sclose);
        const hsize_t length = rows;
        const Hdf5Handle memory_space(::H5Screate_simple(1, &length, nullptr), ::H5Sclose);
        ::H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr);
        if (picks) whole_.resize(rows * memory_.count * memory_.field.size);
        if (::H5Dread(dataset_->id(), memory_.type->id(), memory_space.id(), space.id(), H5P_DEFAULT,
                      picks ? whole_.data() : into) < 0) {
            raise<DataError>(
                "{}: read row {} of {}, expected {} rows of numbers; the file is cut off or damaged",
                file_->bytes->name(), at_ + 1, path(), rows);
        }
        const std::size_t size = memory_.field.size;
        if (picks)
            copy_numbers({whole_.data() + column_ * size, memory_.count * size}, {into, size}, size, rows);
        at_ += rows;
    }

  private:
    std::string path() const {
        std::string name(
            static_cast<std::size_t>(std::max<ssize_t>(0, ::H5Iget_name(dataset_->id(), nullptr, 0))) + 1,
            '\0');
        ::H5Iget_name(dataset_->id(), name.data(), name.size());
        name.pop_back();
        return name;
    }
    std::shared_ptr<Hdf5File> file_;
    std::shared_ptr<Hdf5Handle> dataset_;
    Hdf5Memory memory_;
    std::size_t dimensions_, time_dimension_, column_;
    std::uint64_t at_ = 0;
    std::string whole_;
};

}  // namespace

std::unique_ptr<ColumnCursor> hdf5_column(std::shared_ptr<Hdf5File> file, std::shared_ptr<Hdf5Handle> dataset,
                                          Hdf5Memory memory, std::size_t dimensions,
                                          std::size_t time_dimension, std::size_t column) {
    return std::make_unique<DatasetCursor>(std::move(file), std::move(dataset), std::move(memory), dimensions,
                                           time_dimension, column);
}

}  // namespace ripplenotch

#endif
