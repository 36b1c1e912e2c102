# -DCRSPF_SANITIZE=address,undefined or thread. The two do not mix.
if(CRSPF_SANITIZE)
    if(CRSPF_SANITIZE MATCHES "thread" AND CRSPF_SANITIZE MATCHES "address")
        message(FATAL_ERROR "CRSPF_SANITIZE: thread and address cannot be combined; build twice")
    endif()
    add_compile_options(-fsanitize=${CRSPF_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer -g)
    add_link_options(-fsanitize=${CRSPF_SANITIZE})
endif()
