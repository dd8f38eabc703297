// SPDX-License-Identifier: MIT
#pragma once
// What a run read: a file that is read twice is the same both times, and its SHA-256 is that of the bytes
// that were read, whatever has become of the file.

#include <string>

namespace ripplenotch {

/// From now on a file that this process opens again must be what it was when it was first opened: one that
/// was written to, or gave its name to another, is refused with a FileError. Off at the start; off forgets
/// all.
void watch_inputs(bool wanted);

/// Whether what is read is hashed: not at all, by the thread that reads, or of long files by one beside it.
enum class Hashing { none, here, beside };

/// Of the files watched: from now on every ByteSource hashes what it reads, or none does any longer. It takes
/// about a second for a gigabyte on a processor with instructions for it, five without: only for runs that
/// tell.
void hash_inputs(Hashing how);

/// Of the bytes of `path` as they were first read to their end. Where nobody has read it, it is read now.
/// Empty where inputs are watched and not hashed, for then nothing tells it. Throws FileError.
[[nodiscard]] std::string sha256_as_read(const std::string& path);

}  // namespace ripplenotch
