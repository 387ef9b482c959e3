/* SPDX-License-Identifier: Apache-2.0
 *
 * Types as in the vendor's trees of 2011, where they differ from the types of <stdint.h>. */
#ifndef __SYS_TYPES_H__
#define __SYS_TYPES_H__

typedef char int8;
typedef unsigned char uint8;
typedef short int16;
typedef unsigned short uint16;
typedef int int32;
typedef unsigned int uint32;
typedef long long int64;
typedef unsigned long long uint64;
typedef unsigned long uintpsize;

#endif
