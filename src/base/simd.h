#pragma once
// Four doubles as one value, by the compilers' vector extension: no intrinsics, any instruction set.
namespace frana {

typedef double Double4 __attribute__((vector_size(32)));

}  // namespace frana
