// SPDX-License-Identifier: MIT
#include "log/containers/hdf5_writer.hpp"

#include "ripplenotch/core/error.hpp"

#if defined(RIPPLENOTCH_HAS_HDF5)

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>
#include <vector>

#include "core/files/open_file.hpp"
#include "log/containers/hdf5_files.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t rows_of_a_chunk = 16384;  // rows

class Hdf5TableWriter final : public TableWriter {
  public:
    explicit Hdf5TableWriter(ByteSink& sink) : sink_(sink) {}
    void begin(std::span<const std::string> names) override {
        ::H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
        names_.assign(names.begin(), names.end());
        waiting_.resize(names_.size());
        scratch_ = create_hdf5();
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
        require(::H5Fflush(scratch_.file.id(), H5F_SCOPE_LOCAL) >= 0);
        scratch_.file = {};
        std::vector<char> piece(std::size_t{1} << 20);
        for (off_t at = 0;;) {
            const ssize_t got = ::pread(scratch_.bytes->descriptor(), piece.data(), piece.size(), at);
            if (got < 0 && errno == EINTR) continue;
            if (got < 0) raise<FileError>("cannot read a temporary file back: {}", system_reason());
            if (got == 0) break;
            sink_.write({piece.data(), static_cast<std::size_t>(got)});
            at += got;
        }
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
            std::replace(name.begin(), name.end(), '/', '_');
            datasets_.emplace_back(::H5Dcreate2(scratch_.file.id(), name.c_str(), H5T_IEEE_F64LE, space.id(),
                                                H5P_DEFAULT, creation.id(), H5P_DEFAULT),
                                   ::H5Dclose);
            require(datasets_.back().good());
        }
    }

    ByteSink& sink_;
    std::vector<std::string> names_;
    std::vector<std::vector<double>> waiting_;  ///< by column: rows of a chunk that is not full
    Hdf5Scratch scratch_;
    std::vector<Hdf5Handle> datasets_;  ///< closed before the file
    hsize_t rows_ = 0;
};

}  // namespace

std::unique_ptr<TableWriter> make_hdf5_table(ByteSink& sink, const WriteOptions& /*options*/) {
    return std::make_unique<Hdf5TableWriter>(sink);
}

}  // namespace ripplenotch
#else
namespace ripplenotch {

std::unique_ptr<TableWriter> make_hdf5_table(ByteSink& /*sink*/, const WriteOptions& /*options*/) {
    raise<UsageError>("this build was made without libhdf5; install it and build again, or write .npy");
}

}  // namespace ripplenotch
#endif
