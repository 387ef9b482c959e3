// SPDX-License-Identifier: Apache-2.0
//
// Build files of clients ask for libhw and libhwd by name; all that they need is in libplus.
extern "C" const char* const rths_scramnet_hardware;
extern "C" const char* const rths_scramnet_hardware = "software ring";
