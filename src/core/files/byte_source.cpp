// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "core/files/hash_beside.hpp"
#include "core/files/inputs_read.hpp"
#include "core/files/open_file.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t first_room = std::size_t{1} << 14;  // for a whole file: most are tables and models

std::string shown_name(const std::string& path) {
    return path == "-" ? "standard input" : visible_text(path);
}

}  // namespace

ByteSource::ByteSource(const std::string& path) : ByteSource(std::make_shared<const OpenFile>(path)) {}

ByteSource::ByteSource(std::shared_ptr<const OpenFile> file) : ByteSource(file, shown_name(file->path())) {
    const Hashing how = how_to_hash(*file_, name_);
    if (how == Hashing::none) return;
    // A thread may read it once more: end() notices what was written meanwhile, where the size is known.
    hash_ = how == Hashing::beside && by_place() && size_
                ? std::make_unique<HashBeside>(file_->descriptor(), at_)
                : std::make_unique<HashBeside>();
}

ByteSource::ByteSource(std::shared_ptr<const OpenFile> file, std::string name)
    : name_(std::move(name)), file_(std::move(file)) {
    const FileState& state = file_->state();
    at_ = static_cast<std::uint64_t>(file_->begin());
    if (file_->by_place() && state.size > 0) size_ = static_cast<std::uint64_t>(state.size);
    Progress::current().begin("reading", "B", size_);
}

ByteSource::ByteSource(std::string name, std::shared_ptr<const std::string> bytes, std::size_t piece_size)
    : name_(std::move(name)), bytes_(std::move(bytes)), piece_size_(piece_size), size_(bytes_->size()) {}

ByteSource::ByteSource(Name name) : name_(std::move(name.name)) {}

ByteSource::~ByteSource() = default;

std::size_t ByteSource::read(char* into, std::size_t size) {
    if (bytes_) {
        const std::size_t taken = bytes_->copy(into, std::min(size, piece_size_), at_);
        at_ += taken;
        return taken;
    }
    while (true) {
        const int from = file_->descriptor();
        const ssize_t got =
            file_->by_place() ? ::pread(from, into, size, static_cast<off_t>(at_)) : ::read(from, into, size);
        if (got > 0) {
            take({into, static_cast<std::size_t>(got)});
            return static_cast<std::size_t>(got);
        }
        if (got == 0) {
            if (size > 0) end();
            return 0;
        }
        if (errno != EINTR) raise<FileError>("{}: cannot read: {}", name_, system_reason());
    }
}

void ByteSource::take(std::string_view bytes) {
    at_ += bytes.size();
    if (hash_) hash_->update(bytes);
    Progress::current().add(bytes.size());
}

void ByteSource::end() {
    if (std::exchange(ended_, true)) return;
    file_->require_unchanged(static_cast<off_t>(at_), name_);
    if (hash_) note_hash(*file_, hash_->hex());
}

bool ByteSource::by_place() const { return file_ != nullptr && file_->by_place(); }

int ByteSource::descriptor_by_place() {
    if (hash_) note_hash(*file_, "");
    hash_.reset();
    return file_->descriptor();
}

void ByteSource::require_unchanged() const { file_->require_unchanged(file_->state().size, name_); }

std::string read_all(const std::string& path) {
    ByteSource source(path);
    std::string bytes;
    std::size_t have = 0, got = 1;
    for (std::size_t room = first_room; got > 0; room = 2 * have) {
        if (bytes.size() < room) bytes.resize(room);
        got = source.read(bytes.data() + have, bytes.size() - have);
        have += got;
    }
    bytes.resize(have);
    return bytes;
}

}  // namespace ripplenotch
