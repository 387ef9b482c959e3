/* SPDX-License-Identifier: Apache-2.0
 *
 * The checks of the name tables in C. The compiler checks functions and globals, as pointers of the
 * type in the table; the test checks constants and layouts when it runs. */
#include <stddef.h>
#include <string.h>

struct name_check {
  const char* name;
  unsigned long found, expected;
};

#define POINTER(type, width) {#type, sizeof(*(type)0), (width)},
#define SIZE(type, bytes) {#type, sizeof(type), (bytes)},
#define FIELD(type, field, at, bytes)              \
  {#type "." #field, offsetof(type, field), (at)}, \
      {#type "." #field, sizeof(((type*)0)->field), (bytes)},
#define CONSTANT(name, value) {#name, (unsigned long)(name), (value)},
#define TEXT(name, value) {#name, (unsigned long)strcmp(name, value), 0},
#define FUNCTION(result, name, arguments) \
  {#name, (unsigned long)((result(*) arguments)name == 0 || !SAME(name, result(*) arguments)), 0},
#define NAME(name) {#name, (unsigned long)(&name == 0), 0},
#define GLOBAL(type, name) {#name, (unsigned long)(&name == 0 || !SAME(&name, type*)), 0},
#define SAME(expression, type) _Generic((expression), type : 1, default : 0)
