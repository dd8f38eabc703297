// SPDX-License-Identifier: MIT
#include "cli/standard_streams.hpp"

#include <fcntl.h>
#include <unistd.h>

namespace ripplenotch {
namespace {

struct Stream {
    int descriptor, mode;
};
// The wrong way round for data, so that using them is an error.
constexpr Stream streams[] = {{STDIN_FILENO, O_WRONLY}, {STDOUT_FILENO, O_RDONLY}, {STDERR_FILENO, O_WRONLY}};

}  // namespace

void fill_closed_streams() {
    for (const Stream& stream : streams) {
        if (::fcntl(stream.descriptor, F_GETFD) >= 0) continue;
        // The lowest free number is this one: those below are open by now.
        static_cast<void>(!::open("/dev/null", stream.mode));
    }
}

}  // namespace ripplenotch
