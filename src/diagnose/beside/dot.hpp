// SPDX-License-Identifier: MIT
#pragma once
#include "core/vectors/dot.hpp"
