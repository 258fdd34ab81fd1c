#pragma once

#include <cstddef>
#include <new>
#include <vector>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace grainfield {

/// Memory backed by huge pages where the system permits: where accesses are scattered over tens of
/// megabytes, the translation of addresses costs 10–30 % of the time.
template <class T>
struct HugePageAllocator {
    using value_type = T;
    HugePageAllocator() = default;
    template <class U>
    HugePageAllocator(const HugePageAllocator<U>&) {}

    T* allocate(std::size_t count) {
        const std::size_t bytes = count * sizeof(T);
        const std::size_t alignment = bytes >= kHuge ? kHuge : 64;
        void* memory = ::operator new(bytes, std::align_val_t(alignment));
#if defined(__linux__)
        if (bytes >= kHuge) madvise(memory, bytes, MADV_HUGEPAGE);
#endif
        return static_cast<T*>(memory);
    }
    void deallocate(T* memory, std::size_t count) {
        const std::size_t alignment = count * sizeof(T) >= kHuge ? kHuge : 64;
        ::operator delete(memory, std::align_val_t(alignment));
    }
    template <class U>
    bool operator==(const HugePageAllocator<U>&) const {
        return true;
    }

 private:
    static constexpr std::size_t kHuge = std::size_t{1} << 21;
};

/// Asks for the cache line of `address`. An instruction of its own, because compilers may drop
/// calls of functions that do nothing but prefetch.
inline void fetch_line(const void* address) {
#if defined(__x86_64__)
    asm volatile("prefetcht0 %0" : : "m"(*static_cast<const char*>(address)));
#else
    __builtin_prefetch(address);
#endif
}

template <class T>
using HugeVector = std::vector<T, HugePageAllocator<T>>;

}  // namespace grainfield
