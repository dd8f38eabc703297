// SPDX-License-Identifier: MIT
// Empty: the target of the tests that owns their precompiled headers.
