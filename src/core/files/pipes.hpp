// SPDX-License-Identifier: MIT
#pragma once
// Internal: room in pipes.

#include <fcntl.h>

namespace ripplenotch {

/// A pipe holds 64 KiB: who writes and who reads it take turns every few microseconds. No more than the
/// system lets everybody have; where it does not, all goes on as it is.
inline void widen_pipe(int descriptor) {
#if defined(F_SETPIPE_SZ)
    static_cast<void>(::fcntl(descriptor, F_SETPIPE_SZ, 1 << 20));
#else
    static_cast<void>(descriptor);
#endif
}

}  // namespace ripplenotch
