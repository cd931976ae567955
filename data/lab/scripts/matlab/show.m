function show(name, number, unit)
% Print a result.
fprintf('%s = %.9g %s\n', name, number, unit);
end
