def write_notebooks(folder):
    raise NotImplementedError
