/* Coefficients of the embedded pastes, pastes.csv, byte for byte. */
    .section .rodata
    .global miebrdf_embedded_pastes
    .hidden miebrdf_embedded_pastes
miebrdf_embedded_pastes:
    .incbin MIEBRDF_EMBEDDED_PASTES
    .global miebrdf_embedded_pastes_end
    .hidden miebrdf_embedded_pastes_end
miebrdf_embedded_pastes_end:
    .byte 0
    .section .note.GNU-stack, "", %progbits
