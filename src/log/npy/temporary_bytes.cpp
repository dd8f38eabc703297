// SPDX-License-Identifier: MIT
#include "log/npy/temporary_bytes.hpp"

#include <unistd.h>

#include <cerrno>
#include <optional>

#include "core/files/temporary_file.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

TemporaryBytes::TemporaryBytes() {
    TemporaryFile file(temporary_folder() + "/ripplenotch-rows", std::nullopt);
    const int descriptor = file.release_without_name();
    file_.reset(::fdopen(descriptor, "w+b"));
    if (file_) return;
    ::close(descriptor);
    raise<FileError>("cannot make a temporary file for an array; check the temporary folder");
}

void TemporaryBytes::put(std::string_view bytes) {
    flushed_ = false;
    if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size())
        raise<FileError>("cannot write to a temporary file; check the space in the temporary folder");
}

void TemporaryBytes::read_at(std::uint64_t offset, char* into, std::size_t size) {
    if (!flushed_ && std::fflush(file_.get()) != 0)
        raise<FileError>("cannot write to a temporary file; check the space in the temporary folder");
    flushed_ = true;
    while (size > 0) {
        const ssize_t got = ::pread(::fileno(file_.get()), into, size, static_cast<off_t>(offset));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) raise<FileError>("cannot read a temporary file back");
        into += got;
        size -= static_cast<std::size_t>(got);
        offset += static_cast<std::uint64_t>(got);
    }
}

void TemporaryBytes::rewind() { std::rewind(file_.get()); }

std::size_t TemporaryBytes::read(char* into, std::size_t size) {
    const std::size_t got = std::fread(into, 1, size, file_.get());
    if (std::ferror(file_.get()) != 0) raise<FileError>("cannot read a temporary file back");
    return got;
}

}  // namespace ripplenotch
