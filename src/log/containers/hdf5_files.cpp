// SPDX-License-Identifier: MIT
#if defined(RIPPLENOTCH_HAS_HDF5)

#include "log/containers/hdf5_files.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <optional>
#include <string>

#include "core/files/open_file.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr std::uint64_t piece_size = std::uint64_t{1} << 20;

std::string place_of_copies() { return temporary_folder() + "/ripplenotch-hdf5"; }

// Without locks, which many network file systems refuse: a file that changes while it is read is noticed
// without them.
Hdf5Handle access_of_files() {
    Hdf5Handle access(::H5Pcreate(H5P_FILE_ACCESS), ::H5Pclose);
#if H5_VERSION_GE(1, 10, 7)
    ::H5Pset_file_locking(access.id(), false, true);
#endif
    return access;
}

void write_all_to(int descriptor, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t taken = ::write(descriptor, bytes.data(), bytes.size());
        if (taken < 0 && errno == EINTR) continue;
        if (taken < 0) {
            raise<FileError>("cannot write to a temporary file: {}; TMPDIR=FOLDER names another place",
                             system_reason());
        }
        bytes.remove_prefix(static_cast<std::size_t>(taken));
    }
}

}  // namespace

Hdf5Handle open_hdf5(StoredBytes& bytes) {
    const Hdf5Handle access = access_of_files();
    std::string name = bytes.openable();
    std::optional<TemporaryFile> copy;
    if (name.empty()) {
        copy.emplace(place_of_copies(), std::nullopt);
        for (std::uint64_t at = 0; at < bytes.size(); at += piece_size) {
            const auto size = std::min(piece_size, bytes.size() - at);
            write_all_to(copy->descriptor(), bytes.text_at(at, static_cast<std::size_t>(size)));
        }
        name = copy->name_for_a_moment(place_of_copies());
    }
    return {::H5Fopen(name.c_str(), H5F_ACC_RDONLY, access.id()), ::H5Fclose};
}

Hdf5Scratch create_hdf5() {
    const Hdf5Handle access = access_of_files();
    Hdf5Scratch scratch{{}, std::make_unique<TemporaryFile>(place_of_copies(), std::nullopt)};
    const std::string& name = scratch.bytes->name_for_a_moment(place_of_copies());
    scratch.file = Hdf5Handle(::H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), ::H5Fclose);
    if (!scratch.file.good())
        raise<FileError>("cannot write to a temporary file; check the temporary folder");
    scratch.bytes->forget_name();
    return scratch;
}

}  // namespace ripplenotch

#endif
