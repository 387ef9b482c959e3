/* SPDX-License-Identifier: Apache-2.0
 *
 * The header in C11: sizes as C sees them. */
#include <stddef.h>

#include <rths_adapter.h>

_Static_assert(offsetof(rths_adapter, stop) == 72, "members of minor 0 keep their places");
_Static_assert(sizeof(rths_signal) == 48, "rths_signal does not change within a major version");

size_t size_of_adapter_in_c(void) { return sizeof(rths_adapter); }
