// SPDX-License-Identifier: MIT
#pragma once
// Standard streams that somebody has closed.

namespace ripplenotch {

/// Takes the place of each that is closed, so that no file is opened under its number: a log that is read
/// from there, or a result that is written to there, fails as such; messages for people go nowhere.
void fill_closed_streams();

}  // namespace ripplenotch
