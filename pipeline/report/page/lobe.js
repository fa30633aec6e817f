// lobe
