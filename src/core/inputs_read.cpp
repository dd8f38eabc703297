// SPDX-License-Identifier: MIT
#include "core/inputs_read.hpp"

#include <atomic>
#include <map>
#include <mutex>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/inputs_read.hpp"

namespace ripplenotch {
namespace {

struct Read {
    FileState state;
    std::string sha256;
};

std::atomic<bool> wanted = false;
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

void hash_inputs(bool all) {
    wanted = all;
    const std::lock_guard lock(mutex);
    if (!all) inputs().clear();
}

bool should_hash(const OpenFile& file, std::string_view name) {
    // What comes through standard input is gone when the run ends: no artifact tells its hash.
    if (!wanted || file.path() == "-") return false;
    const std::lock_guard lock(mutex);
    const auto found = inputs().find(file.path());
    if (found == inputs().end()) return true;
    if (file.state().regular && !found->second.state.same_bytes(file.state()))
        raise<FileError>(
            "{}: the file is another than when it was read a moment ago; wait until nothing writes to it, or "
            "read a copy",
            name);
    return false;
}

void note_hash(const OpenFile& file, const std::string& sha256) {
    const std::lock_guard lock(mutex);
    inputs().try_emplace(file.path(), Read{file.state(), sha256});
}

std::string sha256_as_read(const std::string& path) {
    const std::string known = known_hash(path);
    return known.empty() ? sha256_of_file(path) : known;
}

}  // namespace ripplenotch
