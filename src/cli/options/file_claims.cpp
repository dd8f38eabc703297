// SPDX-License-Identifier: MIT
#include "cli/options/file_claims.hpp"

#include <sys/stat.h>

#include <filesystem>
#include <optional>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

namespace fs = std::filesystem;

std::optional<struct stat> status_of(const std::string& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return std::nullopt;
    return status;
}

// Of a file that is not there yet: its folder may have two names.
fs::path spelled_out(const std::string& path) {
    std::error_code failed;
    const fs::path whole = fs::weakly_canonical(fs::absolute(path, failed), failed);
    return failed ? fs::path(path).lexically_normal() : whole;
}

bool same_file(const std::string& a, const std::string& b) {
    if (a.empty() || b.empty()) return false;
    const auto one = status_of(a), other = status_of(b);
    if (one && other)
        return S_ISREG(one->st_mode) && one->st_dev == other->st_dev && one->st_ino == other->st_ino;
    return !one && !other && spelled_out(a) == spelled_out(b);
}

}  // namespace

void FileClaims::reads(std::string_view text, std::string_view as) {
    read_.push_back({std::string(text), std::string(as)});
    for (std::size_t at = text.find('='); at != std::string_view::npos; at = text.find('=', at + 1)) {
        const std::string_view value = text.substr(at + 1);
        read_.push_back({std::string(value.substr(0, value.find(','))), std::string(as)});
    }
}

void FileClaims::writes(std::string_view path, std::string_view as) {
    if (path != "-") written_.push_back({std::string(path), std::string(as)});
}

void FileClaims::check(std::string_view remedy) const {
    for (std::size_t i = 0; i < written_.size(); ++i) {
        const Claim& out = written_[i];
        for (std::size_t j = 0; j < i; ++j) {
            if (!same_file(out.path, written_[j].path)) continue;
            raise<UsageError>("{} and {} both name {}: one would take the place of the other; name two files",
                              written_[j].as, out.as, out.path);
        }
        for (const Claim& in : read_) {
            if (!same_file(out.path, in.path)) continue;
            raise<UsageError>(
                "{} {}: that file is read too ({}), and would be gone for good; name another file{}", out.as,
                out.path, in.as, remedy);
        }
    }
}

}  // namespace ripplenotch
