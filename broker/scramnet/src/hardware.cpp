// SPDX-License-Identifier: Apache-2.0
//
// Build files of clients link libhw, libhwd, libwin and libtst. Their content is in libplus.
extern "C" const char* rths_scramnet_hardware(void);
extern "C" const char* rths_scramnet_hardware(void) { return "ring in shared memory"; }
