/* SPDX-License-Identifier: Apache-2.0
 *
 * Types of the vendor's SCRAMNet GT API. */
#ifndef __SYS_TYPES_H__
#define __SYS_TYPES_H__

#include <stddef.h>
#include <stdint.h>

#if !defined(PLATFORM_UNIX) && !defined(PLATFORM_WIN) && !defined(PLATFORM_VXWORKS) && \
    !defined(PLATFORM_RTX) && !defined(PLATFORM_VISA)
#define PLATFORM_UNIX
#endif

typedef int8_t int8;
typedef uint8_t uint8;
typedef int16_t int16;
typedef uint16_t uint16;
typedef int32_t int32;
typedef uint32_t uint32;
typedef int64_t int64;
typedef uint64_t uint64;
typedef uintptr_t uintpsize;

#define PTR_TO_UINT64(pointer) ((uint64)(uintpsize)(pointer))
#define UINT64_TO_PTR(type, value) ((type*)(uintpsize)(value))
#define NULLPTR NULL

#endif
