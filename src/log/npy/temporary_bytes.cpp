// SPDX-License-Identifier: MIT
#include "log/npy/temporary_bytes.hpp"

#include <unistd.h>

#include <optional>

#include "core/temporary_file.hpp"
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
    if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size())
        raise<FileError>("cannot write to a temporary file; check the space in the temporary folder");
}

void TemporaryBytes::rewind() { std::rewind(file_.get()); }

std::size_t TemporaryBytes::read(char* into, std::size_t size) {
    const std::size_t got = std::fread(into, 1, size, file_.get());
    if (std::ferror(file_.get()) != 0) raise<FileError>("cannot read a temporary file back");
    return got;
}

}  // namespace ripplenotch
