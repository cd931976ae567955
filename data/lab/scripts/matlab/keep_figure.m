function keep_figure(name)
% Keep the current figure as NAME.png, which shows it where there is no desktop, too.
print(gcf, [name '.png'], '-dpng');
end
