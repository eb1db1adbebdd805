# libtorch takes whatever BLAS Debian's alternatives point to. The reference one makes matrix
# products about forty times slower than OpenBLAS, so it is refused here, not found out later.
function(recollect_check_blas)
  set(blas /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/libblas.so.3)
  if(NOT EXISTS ${blas})
    return()
  endif()
  file(REAL_PATH ${blas} real)
  if(real MATCHES "/blas/libblas")
    message(FATAL_ERROR
      "libblas.so.3 is the slow reference BLAS (${real}). "
      "Run 'make setup', or: apt-get install libopenblas0-pthread")
  endif()
endfunction()
