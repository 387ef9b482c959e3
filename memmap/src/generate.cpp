// SPDX-License-Identifier: Apache-2.0
#include <rths/memmap/map.hpp>
