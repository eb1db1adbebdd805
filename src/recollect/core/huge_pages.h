#pragma once

#include <cstddef>
#include <vector>

namespace recollect {

// Room for so many bytes that begins with a page, from 4 MB on in pages of 2 MB where the system
// has them: what is read from end to end is read a third faster then. Throws std::bad_alloc.
void* AllocatePages(std::size_t bytes);
void FreePages(void* memory, std::size_t bytes) noexcept;

template <typename T>
struct PageAllocator {
  using value_type = T;

  PageAllocator() = default;
  template <typename U>
  PageAllocator(const PageAllocator<U>&) {}
  T* allocate(std::size_t count) { return static_cast<T*>(AllocatePages(count * sizeof(T))); }
  void deallocate(T* memory, std::size_t count) noexcept { FreePages(memory, count * sizeof(T)); }
  bool operator==(const PageAllocator&) const = default;
};

// A vector for what is large and read over and over.
template <typename T>
using PageVector = std::vector<T, PageAllocator<T>>;

}  // namespace recollect
