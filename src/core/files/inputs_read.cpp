// SPDX-License-Identifier: MIT
#include "core/files/inputs_read.hpp"

#include <atomic>
#include <map>
#include <mutex>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

namespace {

struct Read {
    FileState state;  ///< when it was first opened
    std::string sha256;
    bool by_place = false;  ///< read here and there: hashed when somebody asks
};

std::atomic<bool> watched = false, hashed = false;
std::mutex mutex;
std::map<std::string, Read>& inputs() {
    static std::map<std::string, Read> all;
    return all;
}

std::string known_hash(const std::string& path) {
    const std::lock_guard lock(mutex);
    const auto found = inputs().find(path);
    return found == inputs().end() ? "" : found->second.sha256;
}

}  // namespace

void watch_inputs(bool wanted) {
    watched = wanted;
    if (!wanted) hashed = false;
    const std::lock_guard lock(mutex);
    if (!wanted) inputs().clear();
}

void hash_inputs(bool wanted) { hashed = watched && wanted; }

bool to_be_hashed(const OpenFile& file, std::string_view name) {
    // What comes through standard input is gone when the run ends: no artifact tells its hash.
    if (!watched || file.path() == "-") return false;
    const std::lock_guard lock(mutex);
    const Read& known = inputs().try_emplace(file.path(), Read{file.state(), {}}).first->second;
    if (file.state().regular && !known.state.same_bytes(file.state()))
        raise<FileError>(
            "{}: the file is another than when it was read a moment ago; wait until nothing writes to it, or "
            "read a copy",
            name);
    return known.sha256.empty() && !known.by_place && hashed;
}

void note_hash(const OpenFile& file, const std::string& sha256) {
    const std::lock_guard lock(mutex);
    Read& read = inputs().try_emplace(file.path(), Read{file.state(), {}}).first->second;
    if (read.sha256.empty()) read.sha256 = sha256;
    read.by_place = sha256.empty();
}

std::string sha256_as_read(const std::string& path) {
    if (watched && !hashed) return "";
    const std::string known = known_hash(path);
    return known.empty() ? sha256_of_file(path) : known;
}

}  // namespace ripplenotch
